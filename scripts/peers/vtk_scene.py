"""What stands around the volumes of bundles, as VTK has it: camera, lamp, spheres."""

import numpy as np
import vtk


def camera_of(bundle):
    camera = vtk.vtkCamera()
    camera.SetPosition(bundle.eye)
    camera.SetFocalPoint(bundle.eye + bundle.forward)
    camera.SetViewUp(bundle.up)
    if bundle.parallel_height:
        camera.SetParallelProjection(True)
        camera.SetParallelScale(bundle.parallel_height / 2)
    else:
        camera.SetViewAngle(bundle.field_of_view)
    camera.SetClippingRange(bundle.near_and_far)
    return camera


def lamp_of(light):
    lamp = vtk.vtkLight()
    lamp.SetLightTypeToSceneLight()
    lamp.SetPositional(True)
    lamp.SetConeAngle(180)
    lamp.SetPosition(light["position"])
    return lamp


def sphere_of(surface, look):
    """A sphere, lit as the volumes are by their look."""
    source = vtk.vtkSphereSource()
    source.SetRadius(surface["radius"])
    source.SetCenter(surface["centre"])
    source.SetThetaResolution(512)
    source.SetPhiResolution(512)
    mapper = vtk.vtkPolyDataMapper()
    mapper.SetInputConnection(source.GetOutputPort())
    actor = vtk.vtkActor()
    actor.SetMapper(mapper)
    if surface["matrix"]:
        matrix = vtk.vtkMatrix4x4()
        matrix.DeepCopy(np.vstack([surface["matrix"], [0, 0, 0, 1]]).ravel())
        actor.SetUserMatrix(matrix)
    material = actor.GetProperty()
    material.SetInterpolationToPhong()
    material.SetColor(surface["colour"])
    material.SetSpecularColor(1, 1, 1)
    lit = bool(surface["phong"])
    material.SetAmbient(look.GetAmbient() if lit else 1)
    material.SetDiffuse(look.GetDiffuse() if lit else 0)
    material.SetSpecular(look.GetSpecular() if lit else 0)
    material.SetSpecularPower(look.GetSpecularPower())
    return actor


def renderer_of(bundle, volume, look):
    renderer = vtk.vtkRenderer()
    renderer.AddVolume(volume)
    for surface in bundle.panel.get("surfaces", []):
        renderer.AddActor(sphere_of(surface, look))
    renderer.SetActiveCamera(camera_of(bundle))
    renderer.SetTwoSidedLighting(False)
    renderer.SetAutomaticLightCreation(False)
    if bundle.panel["light"]:
        renderer.AddLight(lamp_of(bundle.panel["light"]))
    return renderer
