//! `volref plan`

use crate::folder::{Folder, assert_shown};
use std::path::Path;

/// The plans of the figures, as anybody can ask for them from the root of the repository.
#[test]
fn figures() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let plan = |figure: &str| {
        let scene = format!("fixtures/scenes/figures/{figure}.toml");
        let folder = Folder::new();
        let mut command = folder.command(&["plan", &scene]);
        crate::folder::Run::of(command.current_dir(root).output().unwrap()).shown()
    };
    insta::assert_snapshot!(plan("figure-1"), @r#"
    exit code 0
    --- stdout
    kernel  ray caster: nearest, front to back, Phong, no shadow, leaps over empty space
    volume  70 × 106 × 67 nodes, voxel 0.01, from (-0.02, -0.02, -0.02) to (0.67, 1.03, 0.64)

    effects
      elided   surfaces                the classified model has no surfaces
      on       absorption              densities up to 1  (transfer_function)
      on       emission                the colormap sends out light  (transfer_function)
      elided   single-scattering       the classified model scatters no light; shading stands in for it
      elided   multiple-scattering     the classified model scatters no light; shading stands in for it
      omitted  medium-shadow           not asked for: the scene has no [classified.shadow]
      elided   surface-shadow          the classified model has no surfaces
      on       gradient-shading        the density has a gradient  (classified.phong)
      on       heterogeneity           densities from 0 to 1  (classified.volume)
      elided   chromatic-coefficients  opacity is the same for all colours
      elided   anisotropic-phase       the classified model has no phase function

    defaults filled in
      transfer_function.floor     0.36
      transfer_function.colormap  "heat"
      classified.background       [0, 0, 0]
    "#);
    insta::assert_snapshot!(plan("figure-2"), @r"
    exit code 0
    --- stdout
    kernel  plot of the transfer function

    effects
      elided   surfaces                a plot of the transfer function has no light
      elided   absorption              a plot of the transfer function has no light
      elided   emission                a plot of the transfer function has no light
      elided   single-scattering       a plot of the transfer function has no light
      elided   multiple-scattering     a plot of the transfer function has no light
      elided   medium-shadow           a plot of the transfer function has no light
      elided   surface-shadow          a plot of the transfer function has no light
      elided   gradient-shading        a plot of the transfer function has no light
      elided   heterogeneity           a plot of the transfer function has no light
      elided   chromatic-coefficients  a plot of the transfer function has no light
      elided   anisotropic-phase       a plot of the transfer function has no light

    defaults filled in
      none
    ");
    insta::assert_snapshot!(plan("figure-3"), @r#"
    exit code 0
    --- stdout
    kernel  ray caster: trilinear, front to back, Phong, no shadow, leaps over empty space
    volume  70 × 106 × 67 nodes, voxel 0.01, from (-0.02, -0.02, -0.02) to (0.67, 1.03, 0.64)

    effects
      elided   surfaces                the classified model has no surfaces
      on       absorption              densities up to 1  (transfer_function)
      on       emission                the colormap sends out light  (transfer_function)
      elided   single-scattering       the classified model scatters no light; shading stands in for it
      elided   multiple-scattering     the classified model scatters no light; shading stands in for it
      omitted  medium-shadow           not asked for: the scene has no [classified.shadow]
      elided   surface-shadow          the classified model has no surfaces
      on       gradient-shading        the density has a gradient  (classified.phong)
      on       heterogeneity           densities from 0 to 1  (classified.volume)
      elided   chromatic-coefficients  opacity is the same for all colours
      elided   anisotropic-phase       the classified model has no phase function

    defaults filled in
      transfer_function.floor     0.36
      transfer_function.colormap  "heat"
      classified.background       [0, 0, 0]
    "#);
    insta::assert_snapshot!(plan("figure-4"), @r#"
    exit code 0
    --- stdout
    kernel  ray caster: trilinear, back to front, Phong, no shadow, leaps over empty space
    volume  70 × 106 × 67 nodes, voxel 0.01, from (-0.02, -0.02, -0.02) to (0.67, 1.03, 0.64)

    effects
      elided   surfaces                the classified model has no surfaces
      on       absorption              densities up to 1  (transfer_function)
      on       emission                the colormap sends out light  (transfer_function)
      elided   single-scattering       the classified model scatters no light; shading stands in for it
      elided   multiple-scattering     the classified model scatters no light; shading stands in for it
      omitted  medium-shadow           not asked for: the scene has no [classified.shadow]
      elided   surface-shadow          the classified model has no surfaces
      on       gradient-shading        the density has a gradient  (classified.phong)
      on       heterogeneity           densities from 0 to 1  (classified.volume)
      elided   chromatic-coefficients  opacity is the same for all colours
      elided   anisotropic-phase       the classified model has no phase function

    defaults filled in
      transfer_function.floor     0.36
      transfer_function.colormap  "heat"
      classified.background       [0, 0, 0]
    "#);
    insta::assert_snapshot!(plan("figure-5"), @r#"
    exit code 0
    --- stdout
    panel 1: without shadow
    kernel  ray caster: trilinear, front to back, Phong, no shadow, leaps over empty space
    volume  70 × 106 × 67 nodes, voxel 0.01, from (-0.02, -0.02, -0.02) to (0.67, 1.03, 0.64)

    effects
      elided   surfaces                the classified model has no surfaces
      on       absorption              densities up to 1  (transfer_function)
      on       emission                the colormap sends out light  (transfer_function)
      elided   single-scattering       the classified model scatters no light; shading stands in for it
      elided   multiple-scattering     the classified model scatters no light; shading stands in for it
      omitted  medium-shadow           not asked for: the scene has no [classified.shadow]
      elided   surface-shadow          the classified model has no surfaces
      on       gradient-shading        the density has a gradient  (classified.phong)
      on       heterogeneity           densities from 0 to 1  (classified.volume)
      elided   chromatic-coefficients  opacity is the same for all colours
      elided   anisotropic-phase       the classified model has no phase function

    defaults filled in
      transfer_function.floor     0.36
      transfer_function.colormap  "heat"
      classified.background       [0, 0, 0]

    panel 2: with shadow
    kernel  ray caster: trilinear, front to back, Phong, volume shadow, leaps over empty space
    volume  70 × 106 × 67 nodes, voxel 0.01, from (-0.02, -0.02, -0.02) to (0.67, 1.03, 0.64)

    effects
      elided   surfaces                the classified model has no surfaces
      on       absorption              densities up to 1  (transfer_function)
      on       emission                the colormap sends out light  (transfer_function)
      elided   single-scattering       the classified model scatters no light; shading stands in for it
      elided   multiple-scattering     the classified model scatters no light; shading stands in for it
      on       medium-shadow           densities darken what lies behind  (classified.shadow)
      elided   surface-shadow          the classified model has no surfaces
      on       gradient-shading        the density has a gradient  (classified.phong)
      on       heterogeneity           densities from 0 to 1  (classified.volume)
      elided   chromatic-coefficients  opacity is the same for all colours
      elided   anisotropic-phase       the classified model has no phase function

    defaults filled in
      transfer_function.floor     0.36
      transfer_function.colormap  "heat"
      classified.background       [0, 0, 0]
    "#);
}

#[test]
fn json() {
    let folder = Folder::with_scenes();
    let run = folder.volref(&["plan", "curve.toml", "--json"]);
    assert_eq!(run.code, 0);
    assert_shown!(run.stdout, @r#"
    {
      "schema": "volref/plan/1",
      "scene": "curve.toml",
      "panels": [
        {
          "title": null,
          "kernel": "plot of the transfer function",
          "effects": [
            {
              "effect": "surfaces",
              "state": "elided",
              "reason": "a plot of the transfer function has no light",
              "field": null
            },
            {
              "effect": "absorption",
              "state": "elided",
              "reason": "a plot of the transfer function has no light",
              "field": null
            },
            {
              "effect": "emission",
              "state": "elided",
              "reason": "a plot of the transfer function has no light",
              "field": null
            },
            {
              "effect": "single-scattering",
              "state": "elided",
              "reason": "a plot of the transfer function has no light",
              "field": null
            },
            {
              "effect": "multiple-scattering",
              "state": "elided",
              "reason": "a plot of the transfer function has no light",
              "field": null
            },
            {
              "effect": "medium-shadow",
              "state": "elided",
              "reason": "a plot of the transfer function has no light",
              "field": null
            },
            {
              "effect": "surface-shadow",
              "state": "elided",
              "reason": "a plot of the transfer function has no light",
              "field": null
            },
            {
              "effect": "gradient-shading",
              "state": "elided",
              "reason": "a plot of the transfer function has no light",
              "field": null
            },
            {
              "effect": "heterogeneity",
              "state": "elided",
              "reason": "a plot of the transfer function has no light",
              "field": null
            },
            {
              "effect": "chromatic-coefficients",
              "state": "elided",
              "reason": "a plot of the transfer function has no light",
              "field": null
            },
            {
              "effect": "anisotropic-phase",
              "state": "elided",
              "reason": "a plot of the transfer function has no light",
              "field": null
            }
          ],
          "defaults": [
            {
              "key": "transfer_function.floor",
              "value": "0.36"
            },
            {
              "key": "curve.densities",
              "value": "1.2"
            }
          ]
        }
      ]
    }
    "#);
}

#[test]
fn json_of_a_volume() {
    let folder = Folder::with_scenes();
    let json = folder
        .volref(&["plan", "scene.toml", "--json", "--counters"])
        .json();
    assert_eq!(json["schema"], "volref/plan/1");
    let panel = &json["panels"][0];
    let effects = panel["effects"].as_array().unwrap();
    assert_eq!(effects.len(), 11);
    let shadow = effects
        .iter()
        .find(|effect| effect["effect"] == "medium-shadow")
        .unwrap();
    assert_eq!(shadow["state"], "omitted");
    assert_eq!(shadow["field"], "classified.shadow");
    let counters = panel["counters"].as_object().unwrap();
    assert!(counters["density_lookups"].as_u64().unwrap() > 0);
    assert_eq!(counters["shadow_rays"], 0);
    assert_eq!(counters["gradient_lookups"], 0);
}

#[test]
fn counters() {
    let folder = Folder::with_scenes();
    let run = folder.volref(&["plan", "scene.toml", "--counters"]);
    let work = &run.stdout[run.stdout.find("\nwork\n").unwrap()..];
    insta::assert_snapshot!(work, @"

    work
      520  cells walked
      520  density lookups
      0  gradient lookups
      0  gradients computed
      0  null collisions
      0  phase evaluations
      0  random draws
      0  shadow rays
      0  surface tests
    ");
}

/// A grid of one density: shading and heterogeneity are provably null, and can be forced.
#[test]
fn force_on_a_constant_grid() {
    let folder = Folder::with_scenes();
    folder.write(
        "flat.bin",
        crate::bad_files::grid([3, 3, 3], [1.0; 3], &[0.5; 27]),
    );
    folder.write(
        "flat.toml",
        "[film]\nwidth = 6\nheight = 6\n[classified]\n[classified.phong]\n\
         [classified.volume]\nfile = \"flat.bin\"\n",
    );
    insta::assert_snapshot!(folder.volref(&["plan", "flat.toml", "--counters"]).shown(), @r#"
    exit code 0
    --- stdout
    kernel  ray caster: constant density, front to back, unshaded, no shadow, every sample
    volume  3 × 3 × 3 nodes, voxel 0.5, from (0, 0, 0) to (1, 1, 1)

    effects
      elided   surfaces                the classified model has no surfaces
      on       absorption              densities up to 0.5  (transfer_function)
      on       emission                the colormap sends out light  (transfer_function)
      elided   single-scattering       the classified model scatters no light; shading stands in for it
      elided   multiple-scattering     the classified model scatters no light; shading stands in for it
      omitted  medium-shadow           not asked for: the scene has no [classified.shadow]
      elided   surface-shadow          the classified model has no surfaces
      elided   gradient-shading        the density is constant: its gradient is 0  (classified.phong)
      elided   heterogeneity           every voxel holds 0.5  (classified.volume)
      elided   chromatic-coefficients  opacity is the same for all colours
      elided   anisotropic-phase       the classified model has no phase function

    defaults filled in
      transfer_function.floor             0.36
      transfer_function.reference_length  "1 voxel"
      transfer_function.colormap          "heat"
      classified.interpolation            "trilinear"
      classified.compositing              "front-to-back"
      classified.step                     "0.5 voxels"
      classified.background               [0, 0, 0]
      camera.vertical_fov                 45
      camera.eye                          [0.5, 0.5, -1.2706387170384712]  (before the volume on the −z side, as near as shows all of it)
      camera.target                       [0.5, 0.5, 0.5]  (volume centre)
      camera.up                           [0, 1, 0]
      classified.light.position           [0.5, 2.270638717038471, -1.2706387170384712]  (above the eye, as high as the target is far)
      classified.phong.ambient            0.1
      classified.phong.diffuse            1
      classified.phong.specular           1
      classified.phong.shininess          32

    work
      0  cells walked
      0  density lookups
      0  gradient lookups
      0  gradients computed
      0  null collisions
      0  phase evaluations
      0  random draws
      0  shadow rays
      0  surface tests
    "#);
    let forced = [
        "plan",
        "flat.toml",
        "--counters",
        "--force",
        "heterogeneity",
        "--force",
        "gradient-shading",
    ];
    insta::assert_snapshot!(folder.volref(&forced).shown(), @r#"
    exit code 0
    --- stdout
    kernel  ray caster: trilinear, front to back, Phong, no shadow, every sample
    volume  3 × 3 × 3 nodes, voxel 0.5, from (0, 0, 0) to (1, 1, 1)

    effects
      elided   surfaces                the classified model has no surfaces
      on       absorption              densities up to 0.5  (transfer_function)
      on       emission                the colormap sends out light  (transfer_function)
      elided   single-scattering       the classified model scatters no light; shading stands in for it
      elided   multiple-scattering     the classified model scatters no light; shading stands in for it
      omitted  medium-shadow           not asked for: the scene has no [classified.shadow]
      elided   surface-shadow          the classified model has no surfaces
      on       gradient-shading        forced, although null: the density is constant: its gradient is 0  (classified.phong)
      on       heterogeneity           forced, although null: every voxel holds 0.5  (classified.volume)
      elided   chromatic-coefficients  opacity is the same for all colours
      elided   anisotropic-phase       the classified model has no phase function

    defaults filled in
      transfer_function.floor             0.36
      transfer_function.reference_length  "1 voxel"
      transfer_function.colormap          "heat"
      classified.interpolation            "trilinear"
      classified.compositing              "front-to-back"
      classified.step                     "0.5 voxels"
      classified.background               [0, 0, 0]
      camera.vertical_fov                 45
      camera.eye                          [0.5, 0.5, -1.2706387170384712]  (before the volume on the −z side, as near as shows all of it)
      camera.target                       [0.5, 0.5, 0.5]  (volume centre)
      camera.up                           [0, 1, 0]
      classified.light.position           [0.5, 2.270638717038471, -1.2706387170384712]  (above the eye, as high as the target is far)
      classified.phong.ambient            0.1
      classified.phong.diffuse            1
      classified.phong.specular           1
      classified.phong.shininess          32

    work
      0  cells walked
      100  density lookups
      100  gradient lookups
      27  gradients computed
      0  null collisions
      0  phase evaluations
      0  random draws
      0  shadow rays
      0  surface tests
    "#);
}

/// What is not there cannot be forced: that would be another picture.
#[test]
fn force_of_what_is_omitted_or_absent() {
    let folder = Folder::with_scenes();
    for (scene, effect, reason) in [
        (
            "scene.toml",
            "medium-shadow",
            "the scene has no [classified.shadow]",
        ),
        (
            "scene.toml",
            "gradient-shading",
            "the scene has no [classified.phong]",
        ),
        (
            "scene.toml",
            "surfaces",
            "the classified model has no surfaces",
        ),
        (
            "curve.toml",
            "emission",
            "a plot of the transfer function has no light",
        ),
    ] {
        let run = folder.volref(&["plan", scene, "--force", effect]);
        run.expect(2, &[effect, "would change the picture", reason]);
        assert_eq!(run.stdout, "");
    }
}
