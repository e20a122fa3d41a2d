//! Scenes with mistakes: what, where, and how to mend it.

use crate::folder::{Folder, assert_holds, assert_shown};

/// The scene of [`Folder::with_scenes`] after one edit, and what is said about it.
fn after(old: &str, new: &str) -> String {
    let folder = Folder::with_scenes();
    folder.edit("scene.toml", old, new);
    let before = folder.files();
    let run = folder.volref("render scene.toml -o image.exr");
    assert_eq!(run.code, 2, "{new:?}: {}{}", run.stdout, run.stderr);
    assert_eq!(run.stdout, "");
    assert_eq!(folder.files(), before, "{new:?}: nothing is written");
    format!("{}\n", run.message())
}

/// What a user sees.
#[test]
fn an_error_as_it_is_drawn() {
    let folder = Folder::with_scenes();
    folder.edit("scene.toml", "width = 12", "widht = 12");
    assert_shown!(folder.volref("plan scene.toml").shown(), @r"
    exit code 2
    --- stderr
      × scene.toml:2:1: unknown key `widht` in [film]
       ╭─[scene.toml:2:1]
     1 │ [film]
     2 │ widht = 12
       · ─────
     3 │ height = 10
       ╰────
      help: did you mean `width`?
    ");
}

#[test]
fn unknown_keys() {
    let mut said = String::new();
    for (old, new) in [
        ("height = 10", "hieght = 10"),
        ("[transfer_function]", "[transferfunction]"),
        ("[classified]", "[classified]\ninterpolaton = \"nearest\""),
        ("[classified]", "[classified]\nnear_plane = 0.1"),
        ("[classified]", "[classified.shading]\n[classified]"),
        ("[classified]", "[camera]\nfov = 45\n[classified]"),
        (
            "[classified]",
            "[[panel]]\n[panel.film]\nwidht = 3\n[classified]",
        ),
    ] {
        said.push_str(&after(old, new));
    }
    assert_shown!(said, @r"
    scene.toml:3:1: unknown key `hieght` in [film] help: did you mean `height`?
    scene.toml:5:2: unknown key `transferfunction` in the file help: did you mean `transfer_function`?
    scene.toml:9:1: unknown key `interpolaton` in [classified] help: did you mean `interpolation`?
    scene.toml:9:1: unknown key `near_plane` in [classified] help: allowed keys in [classified]: mode, attenuation, window, isosurface, volume, interpolation, compositing, early_termination, step, background, light, phong, shadow, surface, clip, conventions
    scene.toml:8:13: unknown key `shading` in [classified] help: did you mean `shadow`?
    scene.toml:9:1: unknown key `fov` in [camera] help: allowed keys in [camera]: eye, target, up, vertical_fov, orthographic_height, matrix, fl_x, fl_y, cx, cy, azimuth, elevation, zoom
    scene.toml:10:1: unknown key `widht` in [film] help: did you mean `width`?
    ");
}

#[test]
fn what_an_integral_does_not_cover() {
    let mut said = String::new();
    for more in [
        "early_termination = 0.01",
        "phong = {}",
        "shadow = {}",
        "interpolation = \"nearest\"",
        "conventions = { jitter = true }",
    ] {
        let continuous = format!("[classified]\ncompositing = \"continuous\"\n{more}");
        said.push_str(&after("[classified]", &continuous));
    }
    said.push_str(&after(
        "[classified]",
        "[camera]\nvertical_fov = 40\northographic_height = 2\n[classified]",
    ));
    said.push_str(&after(
        "[classified]",
        "[camera]\northographic_height = 0\n[classified]",
    ));
    assert_shown!(said, @r#"
    scene.toml:10:21: with `compositing = "continuous"` no ray is ended early help: leave the key out
    scene.toml:10:9: with `compositing = "continuous"` light depends on the value alone: nothing is shaded help: leave the table out, or composite samples front to back
    scene.toml:10:10: with `compositing = "continuous"` light depends on the value alone: nothing is in shadow help: leave the table out, or composite samples front to back
    scene.toml:10:17: with `compositing = "continuous"` the field is trilinear help: leave the key out
    scene.toml:10:15: with `compositing = "continuous"` there are no samples that could follow conventions help: leave the table out, or composite samples front to back
    scene.toml:10:23: [camera] mixes `vertical_fov` with `orthographic_height` help: give either `vertical_fov`, or `orthographic_height`
    scene.toml:9:23: `orthographic_height` must be finite and above 0, got 0 help: `camera.orthographic_height`: Height of the image, world units, of a camera with parallel rays, which begin in the plane through the eye. If left out, rays come together in the eye.
    "#);
}

#[test]
fn cameras_by_a_matrix() {
    let mut said = String::new();
    let intrinsics = "fl_x = 50\nfl_y = 50\ncx = 30\ncy = 32\n";
    let matrix =
        |[a, b]: [&str; 2]| format!("matrix = [[{a}], [0, 1, 0, 0], [0, 0, 1, 5], [{b}]]\n");
    let right = matrix(["1, 0, 0, 0", "0, 0, 0, 1"]);
    for keys in [
        right.clone() + intrinsics + "eye = [0, 0, 5]\n",
        right.clone() + intrinsics + "vertical_fov = 40\n",
        right.clone(),
        right.clone() + &intrinsics.replace("fl_y = 50", "fl_y = 0"),
        matrix(["2, 0, 0, 0", "0, 0, 0, 1"]) + intrinsics,
        matrix(["-1, 0, 0, 0", "0, 0, 0, 1"]) + intrinsics,
        matrix(["1, 0, 0, 0", "0, 0, 5, 1"]) + intrinsics,
        "matrix = [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 5]]\n".to_owned() + intrinsics,
    ] {
        said.push_str(&after(
            "[classified]",
            &format!("[camera]\n{keys}[classified]"),
        ));
    }
    assert_shown!(said, @"
    scene.toml:14:7: [camera] mixes `matrix` with `eye` help: give either `matrix`, or `eye`, `target`, `up`, `vertical_fov`, `orthographic_height`, `azimuth`, `elevation`, `zoom`
    scene.toml:14:16: [camera] mixes `matrix` with `vertical_fov` help: give either `matrix`, or `eye`, `target`, `up`, `vertical_fov`, `orthographic_height`, `azimuth`, `elevation`, `zoom`
    scene.toml:9:10: [camera] gives `matrix` without `fl_x` help: give `fl_x` too: Focal length in widths of a pixel: the ray of pixel (i, j) is ((i + 1/2 - cx)/fl_x, -(j + 1/2 - cy)/fl_y, -1) in the camera.
    scene.toml:11:8: `fl_y` must lie in [0.001, 1000000000], got 0 help: `camera.fl_y`: Focal length in heights of a pixel.
    scene.toml:9:10: the first three columns of `matrix` are no right-handed axes of length 1, perpendicular to each other, or its last row is not [0, 0, 0, 1] help: give the map from the camera to the world, row by row, with four decimals or more and without a scale: divide columns by their lengths, invert a map from the world to the camera, and of a camera of OpenCV negate the second and third column
    scene.toml:9:10: the first three columns of `matrix` are no right-handed axes of length 1, perpendicular to each other, or its last row is not [0, 0, 0, 1] help: give the map from the camera to the world, row by row, with four decimals or more and without a scale: divide columns by their lengths, invert a map from the world to the camera, and of a camera of OpenCV negate the second and third column
    scene.toml:9:10: the first three columns of `matrix` are no right-handed axes of length 1, perpendicular to each other, or its last row is not [0, 0, 0, 1] help: give the map from the camera to the world, row by row, with four decimals or more and without a scale: divide columns by their lengths, invert a map from the world to the camera, and of a camera of OpenCV negate the second and third column
    scene.toml:9:10: `matrix` must be 4 rows of four numbers, such as [[1, 0, 0, 0], [0, 1, 0, 0], …] help: `camera.matrix`: Map of the camera into the world, four rows, in place of `eye`, `target`, `up` and `vertical_fov`. Its columns are the directions right and up in the image and backward, of length 1, and the eye: the axes of OpenGL and of `transforms.json`.
    ");
}

#[test]
fn modes_and_what_contradicts_them() {
    let maximum = "mode = \"maximum\"\n";
    let isosurface = "mode = \"isosurface\"\nisosurface = [{ value = 0.5, colour = 1 }]\n";
    let attenuated = "mode = \"attenuated-maximum\"\n";
    let mut said = String::new();
    for keys in [
        "mode = \"maximun\"".to_owned(),
        "mode = \"mip\"".to_owned(),
        format!("{maximum}shadow = {{}}"),
        format!("{maximum}phong = {{}}"),
        format!("{maximum}early_termination = 0.01"),
        format!("{maximum}compositing = \"back-to-front\""),
        format!("{maximum}compositing = \"continuous\"\ninterpolation = \"nearest\""),
        format!("{maximum}attenuation = 1"),
        format!("{maximum}isosurface = [{{ value = 0.5, colour = 1 }}]"),
        format!("{maximum}window = {{ low = 1, high = 1 }}"),
        format!("{maximum}window = {{ low = 2, high = 1 }}"),
        format!("{maximum}window = {{ low = 2 }}"),
        format!("{maximum}window = {{ low = nan, high = 1 }}"),
        format!("{maximum}window = {{ low = 0, high = inf }}"),
        attenuated.to_owned(),
        format!("{attenuated}attenuation = 1"),
        format!("{attenuated}window = {{ low = 0, high = 1 }}\nattenuation = -1"),
        "mode = \"isosurface\"".to_owned(),
        "mode = \"isosurface\"\nisosurface = []".to_owned(),
        "mode = \"isosurface\"\nisosurface = [{ value = inf, colour = 1 }]".to_owned(),
        "mode = \"isosurface\"\nisosurface = [{ value = 1, colour = 1, opacity = 2 }]".to_owned(),
        "mode = \"isosurface\"\nisosurface = [{ value = 1, colour = 1 }, { value = 1.0, colour = 0 }]"
            .to_owned(),
        format!("mode = \"isosurface\"\nisosurface = [{}]", "{ value = 1, colour = 1 },".repeat(65)),
        format!("{isosurface}shadow = {{}}"),
        format!("{isosurface}window = {{ low = 0, high = 1 }}"),
        "window = { low = 0, high = 1 }".to_owned(),
        "isosurface = [{ value = 0.5, colour = 1 }]".to_owned(),
    ] {
        said.push_str(&after("[classified]", &format!("[classified]\n{keys}")));
    }
    assert_shown!(said, @r#"
    scene.toml:9:8: `mode` must be one of "maximum", "minimum", "mean", "sum", "attenuated-maximum", "isosurface", but is "maximun" help: did you mean "maximum"?
    scene.toml:9:8: `mode` must be one of "maximum", "minimum", "mean", "sum", "attenuated-maximum", "isosurface", but is "mip" help: `classified.mode`: Content of a pixel, of the field along its ray: its largest value, its smallest one, its mean or its integral over the way inside the volume (world units), the largest value as the values before it attenuate it, or surfaces of equal value. Sampled every `step`, or exact with `compositing = "continuous"`. If left out, samples are composited.
    scene.toml:10:10: nothing casts a shadow with `mode = "maximum"` help: leave the table out, or `mode`
    scene.toml:10:9: `mode = "maximum"` shows a value, which has no normal help: leave the table out
    scene.toml:10:21: `mode = "maximum"` ends no ray early help: leave the key out
    scene.toml:10:15: `mode = "maximum"` knows one order: from the eye on help: leave the key out, or say "continuous" for exact values
    scene.toml:11:17: with `compositing = "continuous"` the field is trilinear help: leave the key out
    scene.toml:10:15: `mode = "maximum"` attenuates nothing help: leave the key out, or say `mode = "attenuated-maximum"`
    scene.toml:10:14: `mode = "maximum"` shows no surface help: leave the tables out, or say `mode = "isosurface"`
    scene.toml:10:28: the window ends at 1, which is not above its begin, 1 help: give a `high` above `low`; for values shown the other way round, give a table of points that falls
    scene.toml:10:28: the window ends at 1, which is not above its begin, 2 help: give a `high` above `low`; for values shown the other way round, give a table of points that falls
    scene.toml:10:10: missing key `high` in [classified.window] help: `classified.window.high`: Value shown white; above `low`.
    scene.toml:10:18: `low` must be finite, got nan help: `classified.window.low`: Value shown black.
    scene.toml:10:28: `high` must be finite, got inf help: `classified.window.high`: Value shown white; above `low`.
    scene.toml:9:8: `mode = "attenuated-maximum"` needs `attenuation`, per world unit, and [classified.window] help: give both: values attenuate by their position in the window from `low` to `high`
    scene.toml:9:8: `mode = "attenuated-maximum"` needs `attenuation`, per world unit, and [classified.window] help: give both: values attenuate by their position in the window from `low` to `high`
    scene.toml:11:15: `attenuation` must be finite and at least 0, got -1 help: `classified.attenuation`: Attenuation of `attenuated-maximum`, per world unit of the way through a value at the top of the window.
    scene.toml:9:8: `mode = "isosurface"` needs a value help: give [[classified.isosurface]] with `value` and `colour`, once for each surface
    scene.toml:9:8: `mode = "isosurface"` needs a value help: give [[classified.isosurface]] with `value` and `colour`, once for each surface
    scene.toml:10:25: `value` must be finite, got inf help: `classified.isosurface[0].value`: Value of the volume, in the unit of its file.
    scene.toml:10:50: `opacity` must lie in [0, 1], got 2 help: `classified.isosurface[0].opacity`: Fraction of the light behind that is absorbed.
    scene.toml:10:52: two isosurfaces have the value 1 help: leave one of them out: they are one surface
    scene.toml:10:14: 65 isosurfaces are too many: a scene has at most 64 help: `classified.isosurface`: The surfaces of `mode = "isosurface"`, at most 64.
    scene.toml:11:10: nothing casts a shadow with `mode = "isosurface"` help: leave the table out, or `mode`
    scene.toml:11:10: isosurfaces have colours of their own help: leave the key out
    scene.toml:9:10: `window` needs a `mode`: without one, samples are composited help: choose what a pixel shows with `mode`, or leave the key out
    scene.toml:9:14: `isosurface` needs a `mode`: without one, samples are composited help: choose what a pixel shows with `mode`, or leave the key out
    "#);
}

/// A panel is the whole scene again: their number times what the scene holds is what they take.
#[test]
fn too_many_panels() {
    let panels = |count: usize| format!("{}[classified]", "[[panel]]\n".repeat(count));
    let mut said = after("[classified]", &panels(257));
    let point = "\n[[transfer_function.point]]\nvalue = 0\ncolour = 0\nopacity = 0\n";
    let points = format!("{}\n{}", point.repeat(5000), panels(256));
    said.push_str(&after("[classified]", &points));
    assert_shown!(said, @r"
    scene.toml:8:1: 257 panels of a scene this long are too many: at most 256, and 67108864 bytes of all, are read help: render the others from a scene of their own
    scene.toml:25009:1: 256 panels of a scene this long are too many: at most 256, and 67108864 bytes of all, are read help: render the others from a scene of their own
    ");
}

#[test]
fn wrong_types() {
    let mut said = String::new();
    for (old, new) in [
        ("width = 12", "width = \"12\""),
        ("width = 12", "width = 12.0"),
        ("width = 12", "width = [12]"),
        ("[film]\nwidth = 12\nheight = 10", "film = 12"),
        ("[film]\nwidth = 12\nheight = 10", "[[film]]\nwidth = 12"),
        ("\"0.2 voxels\"", "true"),
        ("\"0.2 voxels\"", "\"0.2 pixels\""),
        ("[classified]", "[classified]\ninterpolation = 1"),
        ("[classified]", "[classified]\ninterpolation = \"cubic\""),
        ("[classified]", "[classified]\nbackground = true"),
        ("[classified]", "[classified]\nbackground = [0, 0]"),
        ("[classified]", "[classified]\nbackground = [0, 0, \"0\"]"),
        (
            "[classified]",
            "[camera]\nvertical_fov = \"45\"\n[classified]",
        ),
        ("\"cloud.obj\"", "1"),
        ("[film]", "panel = 1\n[film]"),
        ("[film]", "panel = []\n[film]"),
        ("[film]", "panel = [1]\n[film]"),
        ("[film]", "panel = [{ panel = [] }]\n[film]"),
    ] {
        said.push_str(&after(old, new));
    }
    assert_shown!(said, @r#"
    scene.toml:2:9: `width` must be a whole number from 1 to 16384, not a string help: `film.width`: Columns of pixels.
    scene.toml:2:9: `width` must be a whole number from 1 to 16384, not a float help: `film.width`: Columns of pixels.
    scene.toml:2:9: `width` must be a whole number from 1 to 16384, not an array help: `film.width`: Columns of pixels.
    scene.toml:1:8: `film` must be a table, not an integer help: `film`: The image.
    scene.toml:1:1: `film` must be a table, not an array help: `film`: The image.
    scene.toml:6:20: `reference_length` must be a length: a number in world units, or text such as "0.5 voxels", not a boolean help: `transfer_function.reference_length`: Path length over which the transparency is stated, world units or voxels.
    scene.toml:6:20: `reference_length`: expected a positive length such as 0.01 (world units) or "0.5 voxels", got "0.2 pixels" help: `transfer_function.reference_length`: Path length over which the transparency is stated, world units or voxels.
    scene.toml:9:17: `interpolation` must be one of "trilinear", "nearest", not an integer help: `classified.interpolation`: Interpolation of densities and gradients between nodes.
    scene.toml:9:17: `interpolation` must be one of "trilinear", "nearest", but is "cubic" help: `classified.interpolation`: Interpolation of densities and gradients between nodes.
    scene.toml:9:14: `background` must be a colour: three numbers red, green, blue, such as [1, 0.5, 0], one for all three, or sRGB such as '#ff8000', not a boolean help: `classified.background`: Linear radiance behind the volume.
    scene.toml:9:14: `background` must be a colour: three numbers red, green, blue, such as [1, 0.5, 0], one for all three, or sRGB such as '#ff8000' help: `classified.background`: Linear radiance behind the volume.
    scene.toml:9:14: `background` must be a colour: three numbers red, green, blue, such as [1, 0.5, 0], one for all three, or sRGB such as '#ff8000', not a string help: `classified.background`: Linear radiance behind the volume.
    scene.toml:9:16: `vertical_fov` must be a number, not a string help: `camera.vertical_fov`: Full angle between the top and bottom edge of the image, degrees.
    scene.toml:11:8: `file` must be text in quotes, not an integer help: `classified.volume.file`: Point cloud or grid, in a format that `volref info --help` lists, relative to the folder of the scene.
    scene.toml:1:9: `panel` must be tables in double brackets, [[panel]]
    scene.toml:1:9: `panel` must be tables in double brackets, [[panel]]
    scene.toml:1:10: `panel` must be tables in double brackets, [[panel]]
    scene.toml:1:10: a panel cannot contain panels
    "#);
}

#[test]
fn out_of_range() {
    let mut said = String::new();
    for (old, new) in [
        ("width = 12", "width = 0"),
        ("width = 12", "width = -1"),
        ("width = 12", "width = 16385"),
        ("width = 12", "width = 99999999999999999999"),
        ("\"0.2 voxels\"", "0"),
        ("\"0.2 voxels\"", "\"-1 voxels\""),
        ("\"0.2 voxels\"", "inf"),
        ("[classified]", "[classified]\nstep = 0"),
        ("[classified]", "[classified]\nstep = -0.5"),
        ("[classified]", "[classified]\nstep = nan"),
        ("[classified]", "[classified]\nstep = 1e-300"),
        ("[classified]", "[classified]\nstep = \"1e-12 voxels\""),
        ("[classified]", "[classified]\nbackground = [0, -1, 0]"),
        ("[classified]", "[classified]\nbackground = [0, inf, 0]"),
        (
            "[classified]",
            "[classified]\n[classified.phong]\nambient = -0.1",
        ),
        (
            "[classified]",
            "[classified]\n[classified.phong]\nshininess = 0",
        ),
        ("[classified]", "[camera]\nvertical_fov = 0\n[classified]"),
        ("[classified]", "[camera]\nvertical_fov = 180\n[classified]"),
        ("reference_length = \"0.2 voxels\"", "floor = 1"),
        ("reference_length = \"0.2 voxels\"", "floor = nan"),
        ("resolution = 8", "resolution = 1"),
        ("resolution = 8", "resolution = 3"),
        ("resolution = 8", "resolution = 4097"),
        ("padding = 1", "padding = -1"),
    ] {
        said.push_str(&after(old, new));
    }
    assert_shown!(said, @r#"
    scene.toml:2:9: `width` must lie in [1, 16384], got 0 help: `film.width`: Columns of pixels.
    scene.toml:2:9: `width` must lie in [1, 16384], got -1 help: `film.width`: Columns of pixels.
    scene.toml:2:9: `width` must lie in [1, 16384], got 16385 help: `film.width`: Columns of pixels.
    scene.toml:2:9: `width` must lie in [1, 16384], got 99999999999999999999 help: `film.width`: Columns of pixels.
    scene.toml:6:20: `reference_length`: expected a positive length such as 0.01 (world units) or "0.5 voxels", got "0" help: `transfer_function.reference_length`: Path length over which the transparency is stated, world units or voxels.
    scene.toml:6:20: `reference_length`: expected a positive length such as 0.01 (world units) or "0.5 voxels", got "-1 voxels" help: `transfer_function.reference_length`: Path length over which the transparency is stated, world units or voxels.
    scene.toml:6:20: `reference_length` must be finite, got inf help: `transfer_function.reference_length`: Path length over which the transparency is stated, world units or voxels.
    scene.toml:9:8: `step`: expected a positive length such as 0.01 (world units) or "0.5 voxels", got "0" help: `classified.step`: Distance between samples along a ray, world units or voxels.
    scene.toml:9:8: `step`: expected a positive length such as 0.01 (world units) or "0.5 voxels", got "-0.5" help: `classified.step`: Distance between samples along a ray, world units or voxels.
    scene.toml:9:8: `step` must be finite, got nan help: `classified.step`: Distance between samples along a ray, world units or voxels.
    scene.toml:9:8: a step of 1e-300 world units means up to 2.1e300 samples on a ray; at most 1e8 are accepted help: `classified.step`: Distance between samples along a ray, world units or voxels.
    scene.toml:9:8: a step of 2e-13 world units means up to 1.0e13 samples on a ray; at most 1e8 are accepted help: `classified.step`: Distance between samples along a ray, world units or voxels.
    scene.toml:9:14: `background` must be finite and at least 0 in every channel, got [0, -1, 0] help: `classified.background`: Linear radiance behind the volume.
    scene.toml:9:14: `background` must be finite, got inf help: `classified.background`: Linear radiance behind the volume.
    scene.toml:10:11: `ambient` must be finite and at least 0, got -0.1 help: `classified.phong.ambient`: Weight of the ambient term, the same on every side.
    scene.toml:10:13: `shininess` must lie in [1, 1048576], got 0 help: `classified.phong.shininess`: Exponent of the highlight, a whole number.
    scene.toml:9:16: `vertical_fov` must lie in (0, 180), got 0 help: `camera.vertical_fov`: Full angle between the top and bottom edge of the image, degrees.
    scene.toml:9:16: `vertical_fov` must lie in (0, 180), got 180 help: `camera.vertical_fov`: Full angle between the top and bottom edge of the image, degrees.
    scene.toml:6:9: `floor` must lie in [0, 1), got 1 help: `transfer_function.floor`: Value of exp(−d²) that counts as opaque.
    scene.toml:6:9: `floor` must be finite, got nan help: `transfer_function.floor`: Value of exp(−d²) that counts as opaque.
    scene.toml:12:14: `resolution` must lie in [2, 4096], got 1 help: `classified.volume.resolution`: Point clouds only: nodes along the longest side of the grid the points are splatted to, padding included.
    scene.toml:11:8: cloud.obj: a resolution of 3 with 1 nodes of padding on each side leaves no room for the cloud: use at least 4 help: `classified.volume.file`: Point cloud or grid, in a format that `volref info --help` lists, relative to the folder of the scene.
    scene.toml:12:14: `resolution` must lie in [2, 4096], got 4097 help: `classified.volume.resolution`: Point clouds only: nodes along the longest side of the grid the points are splatted to, padding included.
    scene.toml:13:11: `padding` must lie in [0, 1024], got -1 help: `classified.volume.padding`: Point clouds only: empty nodes kept around the cloud on each side.
    "#);
}

#[test]
fn missing_and_contradictory() {
    let mut said = String::new();
    for (old, new) in [
        ("file = \"cloud.obj\"\n", ""),
        (
            "[classified.volume]\nfile = \"cloud.obj\"\nresolution = 8\npadding = 1\n",
            "",
        ),
        (
            "[classified]",
            "[classified]\n[classified.shadow]\nstep = 1",
        ),
        ("[classified]", "[curve]\n[classified]"),
        (
            "[classified]\n\n[classified.volume]\nfile = \"cloud.obj\"\nresolution = 8\npadding = 1\n",
            "",
        ),
        ("cloud.obj", "cloud.bin"),
        (
            "[classified]",
            "[camera]\neye = [1, 2, 3]\ntarget = [1, 2, 3]\n[classified]",
        ),
        (
            "[classified]",
            "[camera]\neye = [0, 0, 0]\ntarget = [0, 1, 0]\nup = [0, 2, 0]\n[classified]",
        ),
        ("[classified]", "[camera]\nup = [0, 0, 0]\n[classified]"),
        (
            "[classified]",
            "[[panel]]\n[[panel]]\nfilm.height = 4\n[classified]",
        ),
    ] {
        said.push_str(&after(old, new));
    }
    assert_shown!(said, @r#"
    scene.toml:10:1: [classified.volume] has no source help: give one of `file`, `field`
    scene.toml:8:1: missing table [classified.volume] help: `classified.volume`: The densities; in double brackets those of several volumes, at most 64, each with a look of its own.
    scene.toml:9:1: missing key `reference_step` in [classified.shadow] help: `classified.shadow.reference_step`: Path length over which a density of 1 adds 1 to the shadow sum S (with a table of points: over which its opacities apply), world units or voxels; smaller is darker.
    scene.toml:9:1: the file has more than one model: [classified], [curve] help: keep exactly one of [classified], [curve]
    scene.toml: the file has no model help: give one of [classified], [radiative], [curve]
    scene.toml:12:14: `resolution` does not apply to "cloud.bin" help: `classified.volume.resolution`: Point clouds only: nodes along the longest side of the grid the points are splatted to, padding included.
    scene.toml:9:7: the camera is at its target, so it has no direction help: `camera.eye`: Position of the camera, world units; required in a radiative scene.
    scene.toml:11:6: `up` must not be zero or parallel to the viewing direction help: `camera.up`: The direction that points up in the image, any length.
    scene.toml:9:6: `up` must not be zero or parallel to the viewing direction help: `camera.up`: The direction that points up in the image, any length.
    scene.toml:9:1: panels are side by side and must have the same height, but this one has 4 rows, and the first 10
    "#);
}

/// Tables of points: what is no table, and what does not stand beside one.
#[test]
fn transfer_functions_by_points() {
    let mut said = String::new();
    let two = "point = [\n{ value = 0, colour = 1, opacity = 0 },\n{ value = 1, colour = 1, opacity = 1 },\n]";
    for new in [
        "point = []",
        "point = { value = 0, colour = 1, opacity = 0 }",
        "point = [[0, 1, 0]]",
        "point = [{ value = 0, colour = 1 }]",
        "point = [{ value = 0, color = 1, opacity = 1 }]",
        "point = [{ value = 0, colour = 1, opacity = 1.5 }]",
        "point = [{ value = 0, colour = 1, opacity = -0.5 }]",
        "point = [{ value = 1e39, colour = 1, opacity = 1 }]",
        "point = [{ value = nan, colour = 1, opacity = 1 }]",
        "point = [{ value = 0, colour = [0, -1, 0], opacity = 1 }]",
        &two.replace("value = 1", "value = -1"),
        &two.replace(
            "]",
            "{ value = 1, colour = 1, opacity = 0 },\n{ value = 1, colour = 1, opacity = 0 },\n]",
        ),
        &format!("{two}\nfloor = 0.4"),
        &format!("colormap = \"heat\"\n{two}"),
        &format!("{two}\n[classified.shadow]\nreference_step = 0"),
    ] {
        said.push_str(&after("reference_length = \"0.2 voxels\"", new));
    }
    let folder = Folder::with_scenes();
    let points = "[transfer_function]\n".to_owned() + two;
    folder.write(
        "broken.toml",
        crate::folder::CURVE.to_owned() + "densities = 2\n" + &points,
    );
    said.push_str(&(folder.volref("plan broken.toml").message() + "\n"));
    assert_shown!(said, @r#"
    scene.toml:6:9: a table of points needs at least one help: `transfer_function.point`: A table in place of floor and colormap: points in order of their values, joined by straight lines, constant beyond the outermost; two points at one value make a step, where the later holds at the value itself.
    scene.toml:6:9: `point` must be tables in double brackets, [[…]], not a table help: `transfer_function.point`: A table in place of floor and colormap: points in order of their values, joined by straight lines, constant beyond the outermost; two points at one value make a step, where the later holds at the value itself.
    scene.toml:6:9: `point` must be tables in double brackets, [[…]], not an array help: `transfer_function.point`: A table in place of floor and colormap: points in order of their values, joined by straight lines, constant beyond the outermost; two points at one value make a step, where the later holds at the value itself.
    scene.toml:6:10: missing key `opacity` in [transfer_function.point[0]] help: `transfer_function.point[0].opacity`: Opacity over the reference length: the fraction of the light behind that is absorbed.
    scene.toml:6:23: unknown key `color` in [transfer_function.point[0]] help: did you mean `colour`?
    scene.toml:6:45: `opacity` must lie in [0, 1], got 1.5 help: `transfer_function.point[0].opacity`: Opacity over the reference length: the fraction of the light behind that is absorbed.
    scene.toml:6:45: `opacity` must lie in [0, 1], got -0.5 help: `transfer_function.point[0].opacity`: Opacity over the reference length: the fraction of the light behind that is absorbed.
    scene.toml:6:20: `value` must lie in [-340282346638528860000000000000000000000, 340282346638528860000000000000000000000], got 1000000000000000000000000000000000000000 help: `transfer_function.point[0].value`: Value of the volume, in the unit of its file; with `range`, its position in that, from 0 to 1.
    scene.toml:6:20: `value` must be finite, got nan help: `transfer_function.point[0].value`: Value of the volume, in the unit of its file; with `range`, its position in that, from 0 to 1.
    scene.toml:6:32: `colour` must be finite and at least 0 in every channel, got [0, -1, 0] help: `transfer_function.point[0].colour`: Linear radiance of the material before shading.
    scene.toml:8:11: the points must be sorted by value, but -1 follows 0 help: `transfer_function.point[1].value`: Value of the volume, in the unit of its file; with `range`, its position in that, from 0 to 1.
    scene.toml:10:11: three points have the value 1; two make a step, and a third means nothing help: `transfer_function.point[3].value`: Value of the volume, in the unit of its file; with `range`, its position in that, from 0 to 1.
    scene.toml:10:9: [transfer_function] mixes `point` with `floor` help: give either `point`, or `floor`, `colormap`
    scene.toml:7:9: [transfer_function] mixes `point` with `colormap` help: give either `point`, or `floor`, `colormap`
    scene.toml:11:18: `reference_step`: expected a positive length such as 0.01 (world units) or "0.5 voxels", got "0" help: `classified.shadow.reference_step`: Path length over which a density of 1 adds 1 to the shadow sum S (with a table of points: over which its opacities apply), world units or voxels; smaller is darker.
    broken.toml:6:13: the axis of a table of points goes from its first to its last help: remove `densities`
    "#);
}

/// Grids by formula: what is none, and what does not stand beside one.
#[test]
fn formulas() {
    let mut said = String::new();
    let ramp = "field = \"ramp\"\nslope = [1, 0, 0]\n";
    let spots = "field = \"spots\"\n";
    for new in [
        "field = \"rampp\"\nnodes = [8, 8, 8]",
        "field = \"ramp\"\nslope = [1, 0, 0]",
        "field = \"ramp\"\nnodes = [8, 8, 8]",
        &format!("{spots}nodes = [8, 8, 8]"),
        &format!("{ramp}nodes = [8, 0, 8]"),
        &format!("{ramp}nodes = [8, 8]"),
        &format!("{ramp}nodes = [8, 8.5, 8]"),
        &format!("{ramp}nodes = [1024, 1024, 129]"),
        &format!("{ramp}nodes = [8, 8, 8]\nspacing = [1, 0, 1]"),
        &format!("{ramp}nodes = [8, 8, 8]\nresolution = 4"),
        &format!("{ramp}nodes = [8, 8, 8]\nvalue = 0.1"),
        &format!("{ramp}nodes = [8, 8, 8]\nvalue = -2"),
        &format!("{spots}nodes = [8, 8, 8]\nevery = 4\nbright = 0.3"),
        &format!("{spots}nodes = [8, 8, 8]\nslope = [1, 0, 0]"),
        &format!("{spots}nodes = [8, 8, 8]\nspot = [{{ node = [3, 8, 2] }}]"),
        &format!("{spots}nodes = [8, 8, 8]\nspot = [{{ value = 2 }}]"),
        &format!("file = \"cloud.obj\"\n{ramp}nodes = [8, 8, 8]"),
    ] {
        let old = "file = \"cloud.obj\"\nresolution = 8\npadding = 1\n";
        said.push_str(&after(old, &format!("{new}\n")));
    }
    assert_shown!(said, @r#"
    scene.toml:11:9: `field` must be one of "ramp", "spots", but is "rampp" help: did you mean "ramp"?
    scene.toml:11:9: a formula needs `nodes`, the size of its grid help: give it, such as nodes = [64, 64, 32]
    scene.toml:11:9: the field "ramp" needs `slope`, its change from node to node help: give it, such as slope = [0.5, 0, 0.25]
    scene.toml:11:9: the field "spots" has none help: give `every`, such as every = 32, or `spot`, such as spot = [{ node = [3, 4, 5] }]
    scene.toml:13:9: `nodes` must lie in [1, 134217728], got 0 help: `classified.volume.nodes`: With `field`: nodes along x, y and z, in all at most 2^27, which take 512 MiB.
    scene.toml:13:9: `nodes` must be three whole numbers from 1 to 134217728, such as [64, 64, 32] help: `classified.volume.nodes`: With `field`: nodes along x, y and z, in all at most 2^27, which take 512 MiB.
    scene.toml:13:9: `nodes` must be three whole numbers from 1 to 134217728, such as [64, 64, 32] help: `classified.volume.nodes`: With `field`: nodes along x, y and z, in all at most 2^27, which take 512 MiB.
    scene.toml:13:9: 1024 × 1024 × 129 nodes are too many: a formula is computed at no more than 2^27, which take 512 MiB help: give fewer nodes, or a file of that size
    scene.toml:14:11: the node spacing must be positive and finite on every axis, and not below 2.3e-308, got [1, 0, 1] help: `classified.volume.spacing`: With `field` or an .npy or .npz file: distance between nodes along x, y and z, world units; 1 if left out.
    scene.toml:14:14: [classified.volume] mixes `field` with `resolution` help: give either `field`, or `resolution`, `padding`, `replace_non_finite`, `orientation`, `detached_anywhere`, `axes`
    scene.toml:12:9: the value 0.1 of a node is not exact in 32 bits, which hold 0.10000000149011612: give multiples of one power of two, such as 0.125, of which no value has more than 2^24 help: `classified.volume.slope`: For a ramp: the change from node to node along x, y and z. Powers of two are exact.
    scene.toml:11:9: voxel (0, 0, 0) holds -2: densities must be finite and not negative help: for other values, give their `range` in [transfer_function], or [[transfer_function.point]] with `value`, `colour` and `opacity`, once for each point of a table
    scene.toml:14:10: the value 0.3 of a node is not exact in 32 bits, which hold 0.30000001192092896: give multiples of one power of two, such as 0.125, of which no value has more than 2^24 help: `classified.volume.bright`: For spots: the value at the nodes of `every`; 1 if left out.
    scene.toml:11:9: the field "spots" has none help: give `every`, such as every = 32, or `spot`, such as spot = [{ node = [3, 4, 5] }]
    scene.toml:13:8: there is no node (3, 8, 2): nodes are counted from 0, the last is (7, 7, 7) help: `classified.volume.spot`: For spots: single nodes, with their values.
    scene.toml:13:9: missing key `node` in [classified.volume.spot[0]] help: `classified.volume.spot[0].node`: Its numbers along x, y and z, counted from 0.
    scene.toml:12:9: [classified.volume] has more than one source: `file`, `field` help: keep exactly one of `file`, `field`
    "#);
}

/// Values below 0 are no densities; a range and a table of points take them, a medium does not.
#[test]
fn values_below_zero() {
    let folder = Folder::new();
    folder.write(
        "scan.nrrd",
        "NRRD0004\ntype: float\ndimension: 3\nsizes: 2 2 2\nencoding: text\n\n\
         -1000 0 40 300\n1000 -20 7 0\n",
    );
    let scene = "[film]\nwidth = 8\nheight = 8\n[classified.volume]\nfile = \"scan.nrrd\"\n\
                 [classified.phong]\n[classified.shadow]\n";
    let points = "[transfer_function]\npoint = [{ value = -500, colour = 0.5, opacity = 0 },\n\
                  { value = 300, colour = 1, opacity = 0.9 }]\n";
    folder.write("scene.toml", scene);
    folder.write("plain.toml", scene.replace("[classified.shadow]\n", ""));
    let range = "[-1000.0, 1000.0]  (1st to 99.9th percentile of the values of the file)";
    folder
        .volref("plan plain.toml")
        .prints(0, &["transfer_function.range", range]);
    let mut said = String::new();
    folder.write(
        "medium.toml",
        "[camera]\neye = [0, 0, -9]\ntarget = [0, 0, 0]\n[[radiative.medium]]\n\
         sigma_t = 1\nalbedo = 0\n[radiative.medium.grid]\nfile = \"scan.nrrd\"\n",
    );
    said.push_str(&(folder.volref("plan medium.toml").message() + "\n"));
    assert_shown!(said, @r"
    medium.toml:8:8: voxel (0, 0, 0) holds -1000: densities must be finite and not negative help: densities must not be negative: shift or scale the values
    ");
    folder.write("scene.toml", scene.to_owned() + points);
    let run = folder.volref("plan scene.toml");
    run.prints(
        0,
        "values from -1000 to 1000 … classified.shadow.reference_step",
    );
    folder
        .volref("render scene.toml -o image.exr")
        .expect(0, "");
    // The panel with the formula has a range of its own, whatever the first made of the file.
    folder.write(
        "panels.toml",
        scene.replace("[classified.shadow]\n", "")
            + "[[panel]]\n[panel.transfer_function]\n\
         point = [{ value = 0, colour = 1, opacity = 1 }]\n[[panel]]\n",
    );
    folder
        .volref("plan panels.toml")
        .prints(0, &["transfer_function.range", range]);
}

#[test]
fn a_plot_of_the_curve_has_no_volume() {
    let folder = Folder::with_scenes();
    folder.write(
        "broken.toml",
        crate::folder::CURVE.to_owned() + "[camera]\n",
    );
    let mut said = folder.volref("plan broken.toml").message() + "\n";
    let run = folder.volref("render curve.toml -o image.exr --step 1");
    said.push_str(&run.message());
    assert_shown!(said, @r"
    broken.toml:6:1: a plot of the curve has no camera help: `camera`: The eye.
    --step: a plot of the curve has no steps
    ");
}

#[test]
fn not_toml() {
    let mut said = String::new();
    for (old, new) in [
        ("width = 12", "width = "),
        ("width = 12", "width = 12\nwidth = 13"),
        ("width = 12", "width 12"),
        ("[film]", "[film"),
        ("\"cloud.obj\"", "\"cloud.obj"),
        ("width = 12", "width = .5"),
    ] {
        said.push_str(&after(old, new));
    }
    assert_shown!(said, @r#"
    scene.toml:2:9: string values must be quoted, expected literal string help: the file is not valid TOML; see https://toml.io for its rules
    scene.toml:3:1: duplicate key help: the file is not valid TOML; see https://toml.io for its rules
    scene.toml:2:7: key with no value, expected `=` help: the file is not valid TOML; see https://toml.io for its rules
    scene.toml:1:6: unclosed table, expected `]` help: the file is not valid TOML; see https://toml.io for its rules
    scene.toml:11:18: invalid basic string, expected `"` help: the file is not valid TOML; see https://toml.io for its rules
    scene.toml:2:9: invalid mantissa, expected digits help: the file is not valid TOML; see https://toml.io for its rules
    "#);
}

#[test]
fn not_text() {
    let folder = Folder::new();
    folder.write("scene.toml", b"title = \"caf\xe9\"\n");
    let run = folder.volref("plan scene.toml");
    run.expect(2, "scene.toml … not UTF-8");
    folder.write("empty.toml", "");
    let run = folder.volref("plan empty.toml");
    run.expect(
        2,
        &[
            "empty.toml",
            "the file has no model",
            "[classified], [radiative], [curve]",
        ],
    );
}

/// A byte order mark and Windows line ends are no mistakes, and places stay right.
#[test]
fn text_from_windows() {
    let folder = Folder::with_scenes();
    let windows = |text: String| format!("\u{feff}{}", text.replace('\n', "\r\n"));
    folder.write("windows.toml", windows(folder.text("scene.toml")));
    assert_eq!(folder.volref("plan windows.toml").code, 0);
    folder.edit("windows.toml", "width = 12", "width = 0");
    folder
        .volref("plan windows.toml")
        .expect(2, "windows.toml:2:9: `width` must lie");
}

/// Columns count characters, as editors do.
#[test]
fn places_after_letters_of_several_bytes() {
    let folder = Folder::with_scenes();
    let text = "film = { \"héllo, wörld\" = 1 }\n".to_owned() + &folder.text("curve.toml")[29..];
    folder.write("scene.toml", text);
    folder
        .volref("plan scene.toml")
        .expect(2, "scene.toml:1:10: unknown key");
    folder.write(
        "scene.toml",
        "# é\n[curve]\ndensities = { \"ä\" = 1, densities = 2 }\n",
    );
    folder
        .volref("plan scene.toml")
        .expect(2, "scene.toml:3:13: `densities` must be");
}

#[test]
fn no_such_scene() {
    let folder = Folder::with_scenes();
    folder.write("folder/scene.toml", "");
    for command in ["plan", "render"] {
        let output: &[&str] = if command == "render" {
            &["-o", "image.exr"]
        } else {
            &[]
        };
        let run = |scene| folder.volref(&[&[command, scene], output].concat());
        run("none.toml").expect(2, "none.toml: cannot read the scene … give the path");
        run("folder").expect(
            2,
            "folder: cannot read the scene: this is a directory, not a file",
        );
        run("cloud.obj/x").expect(2, "cloud.obj/x: cannot read the scene");
        if command == "plan" {
            run("cloud.obj").expect(2, "cloud.obj: this is a volume, not a scene");
        }
    }
}

#[test]
fn steps_on_the_command_line() {
    let folder = Folder::with_scenes();
    let mut said = String::new();
    for step in [
        &["--step", "0"][..],
        &["--step=0"],
        &["--step", "-1"],
        &["--step=-1"],
        &["--step", "-0.5 voxels"],
        &["--step", "nan"],
        &["--step", "inf"],
        &["--step", "half"],
        &["--step", ""],
        &["--step", "1e-300"],
        &["--step", "1e-12voxels"],
    ] {
        let run = folder.volref(&[&["render", "scene.toml", "-o", "image.exr"], step].concat());
        assert_eq!(run.code, 2, "{step:?}");
        said.push_str(&(run.message() + "\n"));
    }
    assert!(!folder.path("image.exr").exists());
    assert_shown!(said, @r#"
    error: invalid value '0' for '--step <LENGTH>': expected a positive length such as 0.01 (world units) or "0.5 voxels", got "0" For more information, try '--help'.
    error: invalid value '0' for '--step <LENGTH>': expected a positive length such as 0.01 (world units) or "0.5 voxels", got "0" For more information, try '--help'.
    error: invalid value '-1' for '--step <LENGTH>': expected a positive length such as 0.01 (world units) or "0.5 voxels", got "-1" For more information, try '--help'.
    error: invalid value '-1' for '--step <LENGTH>': expected a positive length such as 0.01 (world units) or "0.5 voxels", got "-1" For more information, try '--help'.
    error: invalid value '-0.5 voxels' for '--step <LENGTH>': expected a positive length such as 0.01 (world units) or "0.5 voxels", got "-0.5 voxels" For more information, try '--help'.
    error: invalid value 'nan' for '--step <LENGTH>': expected a positive length such as 0.01 (world units) or "0.5 voxels", got "nan" For more information, try '--help'.
    error: invalid value 'inf' for '--step <LENGTH>': expected a positive length such as 0.01 (world units) or "0.5 voxels", got "inf" For more information, try '--help'.
    error: invalid value 'half' for '--step <LENGTH>': expected a positive length such as 0.01 (world units) or "0.5 voxels", got "half" For more information, try '--help'.
    error: invalid value '' for '--step <LENGTH>': expected a positive length such as 0.01 (world units) or "0.5 voxels", got "" For more information, try '--help'.
    --step: a step of 1e-300 world units means up to 2.1e300 samples on a ray; at most 1e8 are accepted
    --step: a step of 2e-13 world units means up to 1.0e13 samples on a ray; at most 1e8 are accepted
    "#);
}

/// Of a mistake in a long line, a long value or a long list the message shows what can be read.
#[test]
fn messages_are_short() {
    let folder = Folder::with_scenes();
    let long = "ä".repeat(200_000);
    for (scene, place, parts) in [
        (
            format!("[curve]\n[film]\nwidth = \"{long}\"\n"),
            "3:9",
            ["`width` must be", "not a string"],
        ),
        (
            format!("[classified]\nvolume = {{ file = \"cloud.obj\" }}\nstep = \"{long}\"\n"),
            "3:8",
            ["expected a positive length such as", "characters left out"],
        ),
        (
            format!("title = \"{long}\"\nfilm = 1\n[curve]\n"),
            "2:8",
            ["`film` must be", "not an integer"],
        ),
        (
            format!(
                "curve = {{ {} }}\n",
                "a = 1, ".repeat(50_000).trim_end_matches(", ")
            ),
            "1:",
            ["duplicate key", "long.toml"],
        ),
        (
            format!("{long} = 1\n[curve]\n"),
            "1:1",
            ["long.toml", "TOML"],
        ),
    ] {
        folder.write("long.toml", scene);
        let run = folder.volref("plan long.toml");
        run.expect(2, &parts);
        let place = format!("long.toml:{place}");
        assert!(run.stderr.contains(&place), "{place}: {}", run.stderr);
        assert!(
            run.stderr.len() < 8_000,
            "{} bytes: {}",
            run.stderr.len(),
            run.stderr
        );
    }
}

/// As many panels as fit into a file are refused before any of them is read: they took 9 GB.
#[test]
fn a_file_of_panels() {
    let folder = Folder::new();
    let panels = "[[panel]]\n".repeat(1_600_000);
    folder.write("panels.toml", format!("[curve]\n{panels}"));
    let run = folder.volref("plan panels.toml");
    run.expect(2, "1600000 panels of a scene this long are too many");
}

/// Maps that place no volume, each with its line, and a remedy.
#[test]
fn impossible_placements() {
    for row in "\
14 | transform = [[1, 0, 0, 0], [0, 1, 0, 0]] | `transform` must be 3 rows of four numbers … help
14 | transform = [[1, 0, 0], [0, 1, 0], [0, 0, 1]] | `transform` must be 3 rows of four numbers … help
14 | transform = [[nan, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0]] | `transform` must be finite, got nan … help
14 | transform = [[1, 2, 3, 0], [2, 4, 6, 0], [0, 0, 1, 0]] | maps space onto a plane … linearly dependent; correct one of them
14 | transform = [[1e-9, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0]] | a condition beyond 1e8 … stretch and shear less
14 | scale = [1, 1, 1e-12] | a condition beyond 1e8 … stretch and shear less
15 | translate = [1, 0, 0]; scale = 2 | `scale` must be three numbers … help
15 | translate = [1.7e308, 0, 0]; scale = [1e308, 1e308, 1e308] | out of the range of numbers … numbers near 1
14 | scale = [1, 0, 1] | flattens the object … factor other than 0
14 | rotate = { axis = [0, 0, 0], angle = 1 } | an axis other than the zero vector … help
15 | translate = [0, 0, 0]; transform = [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0]] | [classified.volume] mixes `transform` with `translate` … give either `transform`, or `scale`, `rotate`, `translate`"
        .lines()
    {
        let [line, keys, parts] = row.split(" | ").collect::<Vec<_>>()[..] else {
            panic!("{row}");
        };
        let keys = keys.replace("; ", "\n");
        let said = after("padding = 1", &format!("padding = 1\n{keys}"));
        assert!(said.starts_with(&format!("scene.toml:{line}:")), "{said}");
        assert_holds(&said, parts);
    }
}

/// Two volumes, and what is wrong with more.
#[test]
fn volumes_surfaces_and_clips() {
    const TWO: &str = "[film]\nwidth = 4\nheight = 4\n[transfer_function]\n[classified]\n\
                       [[classified.volume]]\nfile = \"cloud.obj\"\nname = \"cloud\"\n\
                       [[classified.volume]]\nfile = \"cloud.obj\"\nname = \"fog\"\n";
    let folder = Folder::with_scenes();
    let mut said = String::new();
    let mut broken = |text: String| {
        folder.write("broken.toml", text);
        let run = folder.volref("render broken.toml -o image.exr");
        assert_eq!(run.code, 2, "{}{}", run.stdout, run.stderr);
        said.push_str(&(run.message() + "\n"));
    };
    for more in [
        "[[classified.volume]]\nfile = \"cloud.obj\"\n".repeat(63),
        "[[classified.clip]]\npoint = [0, 0, 0]\nnormal = [0, 0, 0]\n".into(),
        "[[classified.clip]]\npoint = [0, 0, 0]\nnormal = [0, nan, 1]\n".into(),
        "[[classified.clip]]\npoint = [0, 0, 0]\n".into(),
        "[[classified.clip]]\nvolumes = [\"fog\"]\n".into(),
        "[[classified.clip]]\nbox = { min = [1, 1, 1], max = [0, 2, 2] }\n".into(),
        "[[classified.clip]]\npoint = [0, 0, 0]\nnormal = [0, 0, 1]\nvolumes = [\"fogg\"]\n".into(),
        "[[classified.clip]]\npoint = [0, 0, 90]\nnormal = [0, 0, 1]\nvolumes = [\"fog\"]\n".into(),
        "[[classified.surface]]\ncolour = 1\n".into(),
        "[[classified.surface]]\nsphere = { centre = [0, 0, 0], radius = 1 }\n".into(),
        "[[classified.surface]]\ncolour = -1\nsphere = { centre = [0, 0, 0], radius = 1 }\n".into(),
        "[classified.conventions]\njitter = true\n".into(),
    ] {
        broken(format!("{TWO}{more}"));
    }
    for (old, new) in [
        (
            "[classified]\n",
            "[classified]\ncompositing = \"back-to-front\"\n",
        ),
        ("[classified]\n", "[classified]\nearly_termination = 0.1\n"),
        ("[classified]\n", "[classified]\nmode = \"mean\"\n"),
        ("\"fog\"\n", "\"cloud\"\n"),
        ("\"fog\"\n", "\"fog\"\nstep = 1e-30\n"),
    ] {
        broken(TWO.replace(old, new));
    }
    broken("[classified]\n".into());
    broken("[classified]\nvolume = []\n".into());
    broken("[classified]\nvolume = 1\n".into());
    folder.write("two.toml", TWO);
    for arguments in [
        &["export", "two.toml", "--to", "mitsuba", "-o", "out"][..],
        &["export", "two.toml", "--to", "pbrt", "-o", "out"],
        &["sensitivity", "two.toml", "--of", "opacity", "-o", "s.exr"],
    ] {
        let run = folder.volref(arguments);
        assert_ne!(run.code, 0, "{arguments:?}");
        said.push_str(&(run.message() + "\n"));
    }
    assert_shown!(said, @r#"
    broken.toml:6:1: 65 tables of `volume` are too many: a scene has at most 64 help: `classified.volume`: The densities; in double brackets those of several volumes, at most 64, each with a look of its own.
    broken.toml:14:10: the normal of a plane cannot be 0 help: let it point to the side that is kept
    broken.toml:14:10: `normal` must be finite, got nan help: `classified.clip[0].normal`: Normal of the plane, any length but 0: the side to which it points is kept.
    broken.toml:12:1: [classified.clip[0]] has no shape help: give one of `normal`, `box`
    broken.toml:12:1: [classified.clip[0]] has no shape help: give one of `normal`, `box`
    broken.toml:13:15: the box's min [1, 1, 1] must not exceed its max [0, 2, 2] on any axis; swap them where it does help: `classified.clip[0].box.min`: The corner with the smallest coordinates, world units.
    broken.toml:15:11: there is no volume whose `name` is "fogg" help: `classified.clip[0].volumes`: Names of the volumes that are cut. If left out, all are.
    broken.toml:12:1: a clip leaves nothing of a volume help: remove the volume, or turn a normal around: a clip keeps the side to which its normal points, or the inside of its box
    broken.toml:12:1: [classified.surface[0]] has no shape help: give one of `rectangle`, `sphere`, `box`, `mesh`
    broken.toml:12:1: missing key `colour` in [classified.surface[0]] help: `classified.surface[0].colour`: Linear radiance of the material before shading.
    broken.toml:13:10: `colour` must be finite and at least 0 in every channel, got [-1, -1, -1] help: `classified.surface[0].colour`: Linear radiance of the material before shading.
    broken.toml:12:1: several volumes follow conventions where they are sampled by common steps, without shadow and modulation help: add `volume_steps = "common"`, or leave the table out
    broken.toml:6:15: with several volumes, surfaces, clips or modulation samples are composited front to back help: leave `compositing` out: the order changes no more than rounding
    broken.toml:6:21: with several volumes, surfaces, clips or modulation no ray is ended early help: leave the key out
    broken.toml:6:8: with several volumes, surfaces, clips or modulation samples are composited help: leave `mode` out, or what stands beside the volume, or modulates it; clips may stay
    broken.toml:11:8: another volume has this name, too help: give each volume a name of its own
    broken.toml:12:8: a step of 1e-30 world units means up to 4.9e30 samples on a ray; at most 1e8 are accepted help: `classified.volume[1].step`: Distance between samples of this volume, in place of the scene's: world units or voxels of its own.
    broken.toml:1:1: missing table [classified.volume] help: `classified.volume`: The densities; in double brackets those of several volumes, at most 64, each with a look of its own.
    broken.toml:2:10: `volume` is empty help: `classified.volume`: The densities; in double brackets those of several volumes, at most 64, each with a look of its own.
    broken.toml:2:10: `volume` must be a table, or tables in double brackets, [[…]], not an integer help: `classified.volume`: The densities; in double brackets those of several volumes, at most 64, each with a look of its own.
    mitsuba cannot represent classified: a classified volume: media have coefficients, and no transfer function; export the scene to `bundle`, or its grid alone to `raw`, `nrrd` or `npy` help: nothing was written; remove these features from the scene or replace them
    pbrt cannot represent classified: a classified volume: media have coefficients, and no transfer function; export the scene to `bundle`, or its grid alone to `raw`, `nrrd` or `npy` help: nothing was written; remove these features from the scene or replace them
    this scene has no parameter "opacity"; it has density.1, step.1, grid.x.1, grid.y.1, grid.z.1, turn.x.1, size.x.1, turn.y.1, size.y.1, turn.z.1, size.z.1, density.2, step.2, grid.x.2, grid.y.2, grid.z.2, turn.x.2, size.x.2, turn.y.2, size.y.2, turn.z.2, size.z.2, camera.view, camera.right, camera.down, camera.x, camera.y, camera.z
    "#);
}
