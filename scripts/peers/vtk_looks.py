"""What values look like to VTK: opacity and colour over values, and the shares of each kind of light."""

import numpy as np
import vtk

TABLE = 4096  # entries of the tables that stand for the transfer function


def tables(volume, white):
    """Opacity over the reference length, and the radiance of an opaque sample, over density; or that of white."""
    opacity, colour = vtk.vtkPiecewiseFunction(), vtk.vtkColorTransferFunction()
    transfer = volume.json["transfer_function"]
    if transfer["kind"] == "table":
        for point in transfer["points"]:
            opacity.AddPoint(point["value"], point["opacity"])
            colour.AddRGBPoint(point["value"], *([1, 1, 1] if white else point["colour"]))
        return opacity, colour
    table = volume.table(TABLE)
    for d, a, rgb in zip(np.linspace(*table.range, TABLE), table.opacities, table.colours):
        opacity.AddPoint(d, a)
        colour.AddRGBPoint(d, *([d**2] * 3 if white else rgb))
    return opacity, colour


def projection_tables(volume):
    """Opacity and colour over the values that a projection shows."""
    opacity, colour = vtk.vtkPiecewiseFunction(), vtk.vtkColorTransferFunction()
    opacity.AddPoint(0, 1)
    if "low" in volume.mode:
        colour.AddRGBPoint(volume.mode["low"], 0, 0, 0)
        colour.AddRGBPoint(volume.mode["high"], 1, 1, 1)
        return opacity, colour
    for point in volume.json["transfer_function"]["points"]:
        colour.AddRGBPoint(point["value"], *point["colour"])
    return opacity, colour


def surface_tables(surfaces):
    """Opacity and colour of isosurfaces: steps between their values, over a tenth of the way from one to the next."""
    opacity, colour = vtk.vtkPiecewiseFunction(), vtk.vtkColorTransferFunction()
    surfaces = sorted(surfaces, key=lambda surface: surface["value"])
    values = [surface["value"] for surface in surfaces]
    for surface, before, after in zip(surfaces, [values[0] - 1] + values, values[1:] + [values[-1] + 1]):
        for value in (0.55 * surface["value"] + 0.45 * before, 0.55 * surface["value"] + 0.45 * after):
            opacity.AddPoint(value, surface["opacity"])
            colour.AddRGBPoint(value, *surface["colour"])
    return opacity, colour


def look_of(volume, white=False, ambient=1, diffuse=0, specular=0):
    """What densities look like, by that share of each kind of light."""
    look, phong, surfaces = vtk.vtkVolumeProperty(), volume.json["phong"], (volume.mode or {}).get("surfaces", [])
    for index, surface in enumerate(surfaces):
        look.GetIsoSurfaceValues().SetValue(index, surface["value"])
    if not volume.mode:
        opacity, colour = tables(volume, white)
        look.SetScalarOpacityUnitDistance(volume.reference_length)
    else:
        opacity, colour = surface_tables(surfaces) if surfaces else projection_tables(volume)
    look.SetScalarOpacity(opacity)
    look.SetColor(colour)
    look.SetInterpolationType(vtk.VTK_NEAREST_INTERPOLATION if volume.is_nearest else vtk.VTK_LINEAR_INTERPOLATION)
    look.SetShade(bool(phong))
    look.SetAmbient(ambient)
    look.SetDiffuse(diffuse)
    look.SetSpecular(specular)
    look.SetSpecularPower(phong["shininess"] if phong else 1)
    return look


def looks_of(volume, stock):
    """Looks whose pictures add up to that of the panel: the highlight is white, and in stock VTK and of surfaces in one."""
    phong = volume.json["phong"]
    if not phong:
        return [look_of(volume)]
    ambient, diffuse, specular = phong["ambient"], phong["diffuse"], phong["specular"]
    if stock or volume.mode:
        return [look_of(volume, False, ambient, diffuse, specular)]
    coloured = look_of(volume, False, ambient, diffuse)
    return [coloured, look_of(volume, True, 0, 0, specular)] if specular else [coloured]
