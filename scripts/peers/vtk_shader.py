"""Lines of VTK's shader that differ from volref's model by design, and what stands in their place."""

SHADER = {
    # VTK takes its first sample a whole step behind the front face.
    "g_rayJitter = g_dirStep;": "g_rayJitter = 0.5 * g_dirStep;",
    # It stops where less than a 255th of the light would still come through.
    "g_opacityThreshold = 1.0 - 1.0 / 255.0;": "g_opacityThreshold = 1.0;",
    # For a light that has a place, it distorts normals by the proportions of the box,
    "(in_textureToEye[0] * vec4(shading_gradient.xyz, 0.0)).xyz":
        "(transpose(inverse(mat3(in_modelViewMatrix * in_volumeMatrix[0]))) * shading_gradient.xyz)",
    # gives neither ambient light nor highlight a colour, and so no factor of d^2,
    "in_ambient[lightingComponent] * ambient +": "in_ambient[lightingComponent] * color.rgb +",
    "in_specular[lightingComponent] * specular;":
        "in_specular[lightingComponent] * specular * color.rgb;",
    # and takes differences over n/(n - 1) spacings, n the nodes of an axis.
    "vec3(in_cellStep[index].x, 0.0, 0.0)": "vec3(1.0 / float(textureSize(volume, 0).x), 0.0, 0.0)",
    "vec3(0.0, in_cellStep[index].y, 0.0)": "vec3(0.0, 1.0 / float(textureSize(volume, 0).y), 0.0)",
    "vec3(0.0, 0.0, in_cellStep[index].z)": "vec3(0.0, 0.0, 1.0 / float(textureSize(volume, 0).z))",
}  # fmt: skip


def replace_lines(volume, is_mode):
    """Replaces those lines in the shader of a volume."""
    for theirs, ours in SHADER.items():
        if is_mode and "in_specular" in theirs:
            continue  # surfaces have white highlights
        volume.GetShaderProperty().AddFragmentShaderReplacement(theirs, False, ours, False)
