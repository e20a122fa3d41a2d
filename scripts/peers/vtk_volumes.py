"""Volumes of bundles as VTK has them: image data, the mapper that casts rays, placed volumes."""

import numpy as np
import vtk
from vtk.util.numpy_support import numpy_to_vtk

# What VTK calls the modes that it has.
BLENDS = {"maximum": "MaximumIntensity", "minimum": "MinimumIntensity", "mean": "AverageIntensity"}
BLENDS["isosurface"] = "IsoSurface"


def image_of(volume):
    nodes, spacing, first = (np.array(volume.grid[key]) for key in ("nodes", "spacing", "first_node"))
    box_min, values = np.array(volume.grid["box_min"]), volume.values
    if volume.is_of_cells:
        nodes, first = nodes + 1, box_min
    else:
        for axis in np.flatnonzero(nodes == 1):
            # Two layers on the faces, as along such an axis the field is constant.
            values = np.repeat(values, 2, axis=2 - axis)
            nodes[axis], first[axis] = 2, box_min[axis]
            spacing[axis] = volume.grid["box_max"][axis] - box_min[axis]
    image = vtk.vtkImageData()
    image.SetDimensions(nodes.tolist())
    image.SetSpacing(spacing)
    image.SetOrigin(first)
    attributes = image.GetCellData() if volume.is_of_cells else image.GetPointData()
    attributes.SetScalars(numpy_to_vtk(np.ascontiguousarray(values).ravel(), deep=True))
    return image


def planes_of(panel):
    """Points and normals of the planes that clip the volumes."""
    clips = panel.get("clips", [])
    # Of several volumes each names its own; they are the same for all here.
    for clip in [clips[number] for number in panel["volumes"][0]["clips"]] if "volumes" in panel else clips:
        if clip["kind"] == "plane":
            yield clip["point"], clip["normal"]
            continue
        for axis in np.eye(3):
            yield clip["min"], axis
            yield clip["max"], -axis


def mapper_of(bundle):
    mapper = vtk.vtkGPUVolumeRayCastMapper()
    for port, volume in enumerate(bundle.volumes):
        mapper.SetInputDataObject(port, image_of(volume))
    for point, normal in planes_of(bundle.panel):
        plane = vtk.vtkPlane()
        plane.SetOrigin(point)
        plane.SetNormal(normal)
        mapper.AddClippingPlane(plane)
    mapper.AutoAdjustSampleDistancesOff()
    mapper.LockSampleDistanceToInputSpacingOff()
    mapper.UseJitteringOff()
    mode = bundle.panel.get("mode", {"exact": False})
    # What is exact is sampled more finely; several volumes have one step.
    mapper.SetSampleDistance(bundle.step / (16 if mode["exact"] and not bundle.asked_step else 1))
    if "name" in mode:
        getattr(mapper, f"SetBlendModeTo{BLENDS[mode['name']]}")()
    return mapper


def volume_of(mapper, parts, looks):
    """The volume, or several as one."""
    shown = together = vtk.vtkMultiVolume()
    for port, (part, look) in enumerate(zip(parts, looks)):
        volume, matrix = vtk.vtkVolume(), vtk.vtkMatrix4x4()
        volume.SetProperty(look)
        matrix.DeepCopy(part.matrix.ravel())
        volume.SetUserMatrix(matrix)
        if len(parts) == 1:
            shown = volume
        else:
            together.SetVolume(volume, port)
    shown.SetMapper(mapper)
    return shown
