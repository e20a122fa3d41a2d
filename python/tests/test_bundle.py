"""Bundles as arrays, tables and matrices; renderers that serve."""

import json
import os
import subprocess
import sys

import numpy as np
import pytest
import volref


@pytest.fixture(scope="session")
def read(tmp_path_factory):
    """The bundle of a case."""
    folder = tmp_path_factory.mktemp("bundles")
    return lambda name, step=None: volref.bundle(volref.export(name, "bundle", folder / name), step)


def rays(bundle):
    """Origins and directions by the formula of the bundle, of shape (height, width, 3)."""
    ray, (width, height) = bundle.panel["ray"], bundle.size
    x, y = np.meshgrid(np.arange(width), np.arange(height))
    right = np.multiply.outer((2 * x + 1 - width) / height, ray["half_right"])
    down = np.multiply.outer((2 * y + 1 - height) / height, ray["half_up"])
    beside, eye, forward = right - down, np.array(ray["eye"]), np.array(ray["forward"])
    is_parallel = "orthographic_height" in ray
    origins, directions = (eye + beside, forward + 0 * beside) if is_parallel else (eye + 0 * beside, forward + beside)
    return origins, directions / np.linalg.norm(directions, axis=2, keepdims=True)


@pytest.mark.parametrize(
    "name",
    ["figures/figure-3", "limit/orthographic", "scenes/turned", "limit/eye-inside", "scenes/off-centre"],
)
def test_points_of_a_ray_are_projected_to_its_pixel(read, name):
    bundle = read(name)
    (width, height), (near, far) = bundle.size, bundle.near_and_far
    origins, directions = rays(bundle)
    depths = []
    for t in [0.9 * near, 1.1 * near, 0.5 * (near + far)]:
        points = origins + t / (directions @ bundle.forward)[..., None] * directions
        clip = np.insert(points, 3, 1, axis=2) @ (bundle.projection @ bundle.view).T
        place = clip[..., :3] / clip[..., 3:]
        y, x = np.mgrid[:height, :width]
        assert np.abs((place[..., 0] + 1) / 2 * width - (x + 0.5)).max() < 1e-6
        assert np.abs((1 - place[..., 1]) / 2 * height - (y + 0.5)).max() < 1e-6
        depths.append(place[..., 2])
    assert depths[0].max() < -1 < depths[1].min() and depths[2].max() < 1


def test_boxes_lie_between_the_planes_and_the_camera_stands_in_the_world(read):
    for name in ["figures/figure-3", "scenes/mirrored", "scenes/two-fogs", "limit/orthographic"]:
        bundle = read(name)
        near, far = bundle.near_and_far
        corners = np.concatenate([volume.corners for volume in bundle.volumes])
        depths = -(np.insert(corners, 3, 1, axis=1) @ bundle.view.T)[:, 2]
        assert near < depths.min() and depths.max() < far
        backward = -np.array(bundle.panel["ray"]["forward"])
        np.testing.assert_allclose(bundle.camera_to_world[:3, 2], backward, atol=1e-12)
        np.testing.assert_allclose(bundle.camera_to_world[:3, 3], bundle.eye, atol=1e-12)
        np.testing.assert_allclose(bundle.camera_to_world[:3, 1], bundle.up, atol=1e-12)
        half_height = bundle.parallel_height or 2 * np.tan(np.radians(bundle.field_of_view) / 2)
        assert half_height == pytest.approx(2 * np.linalg.norm(bundle.panel["ray"]["half_up"]))


def test_an_affine_places_the_nodes(read):
    volume = read("sampled/thick-slices").volume
    spacing, first = np.array(volume.grid["spacing"]), np.array(volume.grid["first_node"])
    assert len(set(spacing)) > 1
    np.testing.assert_allclose((volume.affine @ [3, 2, 1, 1])[:3], first + spacing * [3, 2, 1])
    assert volume.values.shape == tuple(volume.grid["nodes"][::-1]) and volume.voxel == spacing.min()
    flat = np.fromfile(volume.folder / volume.grid["file"], "<f4")
    nx, ny, _ = volume.grid["nodes"]
    assert volume.values[1, 2, 3] == flat[(1 * ny + 2) * nx + 3]
    turned = read("scenes/turned").volume
    placed = np.array(turned.grid["matrix"])
    node = np.array(turned.grid["first_node"]) + np.array(turned.grid["spacing"]) * [1, 0, 2]
    np.testing.assert_allclose((turned.affine @ [1, 0, 2, 1])[:3], placed[:, :3] @ node + placed[:, 3])
    assert volume.matrix.tolist() == np.eye(4).tolist() and turned.matrix.tolist() != np.eye(4).tolist()


def test_cells_and_nearest_nodes_are_told(read):
    assert read("sampled/cells").volume.is_of_cells and not read("sampled/constant").volume.is_of_cells
    assert read("sampled/nearest-blocks").volume.is_nearest and not read("sampled/cells").volume.is_nearest


def test_a_table_is_in_straight_lines_between_the_points(read):
    bundle = read("sampled/two-point-ramp", step=0.25)
    volume, points = bundle.volume, bundle.panel["transfer_function"]["points"]
    assert len(points) == 2 and bundle.step == 0.25
    table = volume.table(5)
    assert table.range == (points[0]["value"], points[1]["value"])
    share = np.linspace(0, 1, 5)
    opacities = points[0]["opacity"] + share * (points[1]["opacity"] - points[0]["opacity"])
    np.testing.assert_allclose(table.opacities, opacities)
    for channel in range(3):
        first, last = (point["colour"][channel] for point in points)
        np.testing.assert_allclose(table.colours[:, channel], first + share * (last - first))
    reference = volume.reference_length
    of_voxel = 1 - (1 - opacities) ** (volume.voxel / reference)
    np.testing.assert_allclose(volume.table(5, per="voxel").opacities, of_voxel)
    np.testing.assert_allclose(volume.table(5, per="step").opacities, 1 - (1 - opacities) ** (0.25 / reference))
    np.testing.assert_allclose(volume.table(5, per="step", step=reference).opacities, opacities)


def test_a_table_of_a_formula(read):
    volume = read("figures/figure-3").volume
    table = volume.table(11)
    values = np.linspace(*table.range, 11)
    floor = volume.json["transfer_function"]["floor"]
    np.testing.assert_allclose(table.opacities, 1 - ((np.exp(-(values**2)) - floor) / (1 - floor)).clip(0, 1))
    colours = np.array(volume.json["transfer_function"]["colours"])
    np.testing.assert_allclose(table.colours[-1], values[-1] ** 2 * colours[-1])


def test_a_table_with_a_jump_and_one_of_a_window(read):
    jumps = read("sampled/thin").volume
    points = [{"value": v, "opacity": a, "colour": [a] * 3} for v, a in [(0, 0), (1, 0), (1, 0.5), (2, 1)]]
    jumps.json["transfer_function"].update(points=points)
    assert jumps.has_jump
    assert jumps.table(5).opacities.tolist() == [0, 0, 0.5, 0.75, 1]
    grey = read("scenes/maximum-exact").volume
    if grey.json["transfer_function"] is None:
        assert grey.table(2).colours.tolist() == [[0] * 3, [1] * 3] and grey.table(2).range[0] == grey.mode["low"]


def test_what_a_renderer_cannot_say_is_refused_by_name(read, tmp_path):
    read("sampled/constant").allow()
    read("scenes/turned").allow("placed", "shading", "formula", "parallel")
    for name, allowed, words in [
        ("scenes/turned", ["shading"], "placed by a matrix"),
        ("scenes/two-fogs", [], "2 volumes"),
        ("sampled/parallel-z-up", ["nearest"], "parallel rays"),
        ("sampled/nearest-blocks", ["parallel"], "values of the nearest node"),
        ("sampled/formula", ["parallel"], "a transfer function by formulas"),
        ("scenes/sheared", ["placed", "shading", "formula", "parallel"], "^a volume that is sheared$"),
        ("scenes/maximum", ["isosurface"], 'mode = "maximum"'),
        ("scenes/ball-in-rings", ["shading"], "surfaces"),
        ("figures/figure-3", [], "shading"),
        ("figures/figure-2", [], "a plot"),
        ("figures/figure-5", [], "2 panels"),
    ]:
        with pytest.raises(volref.Refusal, match=words):
            read(name).allow(*allowed)
    with pytest.raises(ValueError, match="did you mean 'shading'"):
        read("sampled/constant").allow("shadings")
    parts = read("figures/figure-5")
    assert [parts.alone(index).size for index in range(2)] == [(256, 256)] * 2
    radiative = tmp_path / "radiative.json"
    radiative.write_text('{"schema": "volref/bundle/1", "panels": [{"shows": "radiance", "media": [1]}]}')
    bundle = volref.bundle(radiative)
    assert bundle.panels[0]["media"] == [1] and bundle.json["schema"] == "volref/bundle/1"
    for refused in [lambda: bundle.volumes, lambda: bundle.near_and_far, bundle.allow]:
        with pytest.raises(volref.Refusal, match="no classified volume"):
            refused()


def test_files_that_are_no_bundle(read, tmp_path):
    for name, text in [("a", "{"), ("b", "[1]"), ("c", '{"schema": "volref/bundle/9"}'), ("d", "[" * 100000)]:
        (tmp_path / name).write_text(text)
        with pytest.raises(volref.VolrefError):
            volref.bundle(tmp_path / name)
    with pytest.raises(volref.VolrefError, match="nothing"):
        volref.bundle(tmp_path / "nothing")
    file = volref.export("sampled/constant", "bundle", tmp_path)
    for step in [0, -1, float("nan")]:
        with pytest.raises(ValueError, match="step"):
            volref.bundle(file, step)
    volume = volref.bundle(file).volume
    (tmp_path / volume.grid["file"]).write_bytes(b"1234")
    with pytest.raises(volref.VolrefError, match="1 values"):
        volume.values
    np.save(tmp_path / "values.npy", np.zeros(volume.grid["nodes"][::-1]))
    volume.grid["file"] = "values.npy"
    assert volume.values.dtype == np.float32


UNIT = [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0]]
MIRRORED = [[-2, 0, 0, 5], [0, 1, 0, 0], [0, 0, 1, 0]]


@pytest.mark.parametrize(
    "shape, volume",
    [
        ({"kind": "box", "min": [1, 2, 3], "max": [2, 4, 6]}, 6),
        # A polyhedron within a sphere, whose faces lie up to 1.51e-4 of the radius below it: at most three times that less.
        ({"kind": "sphere", "centre": [1, 2, 3], "radius": 2}, 32 * np.pi / 3),
    ],
)
def test_triangles_look_outwards_and_enclose_the_volume(shape, volume, tmp_path):
    for matrix, factor in [(None, 1), (UNIT, 1), (MIRRORED, 2)]:
        part = volref.Part("media[0]", {"shape": shape, "matrix": matrix}, tmp_path)
        for smaller in [0, 0.1]:
            vertices, triangles = part.triangles(smaller)
            # The divergence theorem: a sixth of the determinants, positive where triangles look outwards.
            enclosed = np.linalg.det(vertices[triangles]).sum() / 6
            expected = volume * factor * (1 - smaller) ** 3
            assert (1 - 4.6e-4) * expected <= enclosed <= (1 + 1e-12) * expected


def test_parts_of_a_radiative_scene(read):
    bundle = read("smoke/cornell")
    assert (len(bundle.surfaces), len(bundle.area_lights), len(bundle.media), bundle.lights) == (5, 1, 2, [])
    assert bundle.size == (256, 256) and bundle.field_of_view == pytest.approx(40)
    np.testing.assert_allclose(bundle.camera_to_world[:3, 3], bundle.radiance["ray"]["eye"])
    medium = bundle.media[0]
    assert medium.key == "media[0]" and medium.coefficients().absorption.tolist() == medium.json["sigma_a"]
    vertices, triangles = bundle.surfaces[0].triangles()
    assert vertices.shape == (4, 3) and triangles.shape == (2, 3)
    mesh = read("known-answers/furnace-mesh").media[0]
    vertices, triangles = mesh.triangles()
    assert triangles.max() == len(vertices) - 1 and np.linalg.det(vertices[triangles]).sum() > 0
    with pytest.raises(volref.Refusal, match=r"media\[0\]\.density: "):
        read("known-answers/absorbing-grid").media[0].coefficients()
    for refused in [lambda: bundle.volumes, lambda: read("figures/figure-3").radiance]:
        with pytest.raises(volref.Refusal, match="no "):
            refused()


def test_samples_are_divided_among_seeds(read):
    each, seeds = volref.divided(64, 3, 16)
    assert each == 4 and len(set(seeds)) == 16 and all(0 <= seed < 2**31 for seed in seeds)
    assert seeds == volref.divided(64, 3, 16)[1] != volref.divided(64, 4, 16)[1]
    assert [len(volref.divided(samples, 0, 16)[1]) for samples in (1, 2, 17)] == [2, 2, 9]
    bundle = read("smoke/cornell")
    assert bundle.renderings(16) == volref.divided(64, 0, 16)
    asked = volref.bundle(bundle.path, request={"spp": 8, "seed": 5})
    assert asked.renderings(16) == volref.divided(8, 5, 16)
    with pytest.raises(ValueError, match="seed"):
        volref.divided(64, -1, 16)


def test_a_program_of_another_export(tmp_path):
    program = tmp_path / "renderer.py"
    program.write_text(
        "import numpy as np, volref\n"
        "def render(request):\n"
        "    assert request['export:mitsuba'].endswith('scene.xml')\n"
        "    return np.full((2, 3, 3), request['spp'] / (1 + request['seed']), np.float32)\n"
        "volref.main(render, export='mitsuba')\n"
    )
    command = [sys.executable, program, "scene.xml", tmp_path / "image.npy"]
    subprocess.run([*command, "--spp", "6", "--seed", "2"], check=True)
    assert (np.load(tmp_path / "image.npy") == 2).all()
    for wrong in (["--spp", "1"], ["--seed", "-1"]):
        assert subprocess.run([*command, *wrong], capture_output=True).returncode == 2


@pytest.mark.parametrize("extension", [".exr", ".npy", ".pfm"])
def test_a_saved_image_is_judged(tmp_path, extension):
    image = volref.render("sampled/constant")[:, :, :3]
    file = volref.save(tmp_path / f"constant{extension}", image.astype(float))
    command = [volref.program(), "validate", "sampled/constant", f"--outputs={tmp_path}", "--json"]
    ran = subprocess.run(command, capture_output=True, text=True)
    assert json.loads(ran.stdout)["cases"][0]["verdict"] == "pass", ran
    assert [file] == list(tmp_path.iterdir())


def test_an_image_is_saved_with_its_noise(tmp_path):
    random = np.random.default_rng(3)
    right = np.full((64, 64, 3), 0.5, np.float32)
    pictures = right + random.normal(0, 0.1, (16, 64, 64, 3))
    volref.save(tmp_path / "right.npy", right)
    by_seeds = volref.save(tmp_path / "seeds.exr", seeds=list(pictures), samples=4)
    variance = np.full((64, 64, 3), 0.01 / 16)
    by_variance = volref.save(tmp_path / "variance.exr", pictures.mean(0), variance=variance, samples=64)
    for file in [by_seeds, by_variance]:
        command = [volref.program(), "compare", tmp_path / "right.npy", file, "--json"]
        found = json.loads(subprocess.run(command, capture_output=True, text=True).stdout)["cases"][0]
        assert (found["verdict"], found["gate"]) == ("pass", "stochastic"), found
    volref.save(tmp_path / "same.exr", seeds=[right, right * (1 + 1e-7)])
    for arguments, words in [
        ({"image": right, "variance": variance}, "samples=N"),
        ({"seeds": [right]}, "two or more"),
        ({"image": right[None]}, "shape"),
    ]:
        with pytest.raises(ValueError, match=words):
            volref.save(tmp_path / "x.exr", **arguments)
    with pytest.raises(ValueError, match="an .exr alone"):
        volref.save(tmp_path / "x.npy", seeds=list(pictures))
    with pytest.raises(ValueError, match=".exr, .npy, .pfm, .png"):
        volref.save(tmp_path / "x.tiff", right)
    with pytest.raises(TypeError, match="divide linear codes by 255"):
        volref.save(tmp_path / "x.npy", np.zeros((2, 2, 3), np.uint8))
    with pytest.raises(TypeError, match="image, or seeds"):
        volref.save(tmp_path / "x.npy")
    assert not list(tmp_path.glob("x*")) and not list(tmp_path.glob(".*"))


RENDERER = """
import argparse, os, sys
import numpy as np
import volref

def render(bundle, level):
    bundle.allow("shading")
    print("library talks")
    os.write(1, b'{"and": "so do its parts"}')
    if level == 7:
        raise RuntimeError("no such\\nlevel")
    if level == 8:
        sys.exit("gone")
    if level == 9:
        return None
    width, height = bundle.size
    return np.full((height, width, 3), level * bundle.step)

parser = argparse.ArgumentParser()
parser.add_argument("--level", type=float, default=0.5)
volref.main(render, parser)
"""


@pytest.fixture
def renderer(tmp_path):
    file = tmp_path / "renderer.py"
    file.write_text(RENDERER)
    return [sys.executable, str(file)]


def ask(renderer, lines, **more):
    """Answers to lines, and what stands on standard error."""
    ran = subprocess.run([*renderer, "--serve"], input=b"".join(lines), capture_output=True, timeout=60, **more)
    assert ran.returncode == 0, ran
    return [json.loads(line) for line in ran.stdout.splitlines()], ran.stderr.decode()


def test_a_renderer_serves(renderer, tmp_path):
    files = {name: volref.export(name, "bundle", tmp_path / name) for name in ["sampled/constant", "scenes/turned"]}

    def request(name, **more):
        value = {"volref": 1, "case": name, "export:bundle": str(files[name]), "output": str(tmp_path / "image.npy")}
        return json.dumps(value | more).encode() + b"\n"

    image = {"image": str(tmp_path / "image.npy")}
    answers, said = ask(renderer, [request("sampled/constant", step=0.5), request("scenes/turned")])
    assert answers == [image, {"cannot": "a volume placed by a matrix"}]
    assert np.load(tmp_path / "image.npy").max() == 0.25
    assert said.count("library talks") == 1 and '{"and"' in said
    hostile = [b"\n", b"{\n", b"[]\n", b"\xff\n", b"[" * 100000 + b"\n", b"x" * 3000000 + b"\n"]
    hostile += [b'{"volref": 1, "output": 3}\n', request("sampled/constant", volref=2)]
    hostile += [request("sampled/constant", step="long"), request("sampled/constant", **{"export:bundle": "nowhere"})]
    answers, _ = ask(renderer, [*hostile, request("sampled/constant")])
    assert [list(answer) for answer in answers] == [["error"]] * len(hostile) + [["image"]]
    assert "version 2" in answers[7]["error"] and "nowhere" in answers[9]["error"]
    (tmp_path / "image.npy").unlink()
    for level, words in [(7, "RuntimeError: no such\nlevel"), (8, "SystemExit: gone"), (9, "returned no image")]:
        answers, said = ask([*renderer, f"--level={level}"], [request("sampled/constant")] * 2)
        assert all(words in answer["error"] for answer in answers) and len(answers) == 2
        assert "Traceback" in said


@pytest.mark.skipif(os.name == "nt", reason="pipes end otherwise")
def test_a_renderer_ends_where_nobody_reads(renderer):
    reads, writes = os.pipe()
    os.close(reads)
    ran = subprocess.run(
        [*renderer, "--serve"], input=b"{}\n" * 50, stdout=writes, stderr=subprocess.PIPE, timeout=60
    )
    os.close(writes)
    assert ran.returncode == 0 and b"BrokenPipe" not in ran.stderr and ran.stderr.count(b"Traceback") == 1


def test_validate_calls_a_renderer_and_lets_it_stay(renderer):
    command = [volref.program(), "validate", "sampled/constant", "scenes/turned", "figures/figure-2", "--json"]
    command += ["--format=npy", "--explain=0"]
    program = " ".join(renderer)
    verdicts = []
    for how in [f"--serve={program} --serve {{export:bundle}} {{step}}",
                f"--run={program} {{export:bundle}} {{output}} --step {{step}}"]:
        ran = subprocess.run([*command, how], capture_output=True, text=True)
        verdicts.append([(case["verdict"], case["reason"]) for case in json.loads(ran.stdout)["cases"]])
    served, called = verdicts
    assert [verdict for verdict, _ in served] == ["fail", "missing", "missing"] or served[0][0] == "missing", served
    assert any("a volume placed by a matrix" in reason for _, reason in served), served
    assert any("refused: a volume placed by a matrix" in reason for _, reason in called), called


def test_panels_stand_side_by_side(tmp_path):
    program = tmp_path / "levels.py"
    program.write_text(
        "import numpy as np, volref\n"
        "volref.main(lambda bundle: np.full((*bundle.size[::-1], 3), 1.0 * bundle.panel['first_column']))"
    )
    bundle = volref.export("figures/figure-5", "bundle", tmp_path)
    subprocess.run([sys.executable, program, bundle, tmp_path / "image.npy"], check=True)
    image = np.load(tmp_path / "image.npy")
    assert image.shape == (256, 512, 3) and image[0, 255, 0] == 0 and image[0, 256, 0] == 256
