#!/usr/bin/env python3
"""What an error costs: volref against Mitsuba 3, and against VTK's ray caster for processors.

    efficiency.py paths SCENE... [--spp N] [--runs R] [--variants scalar_rgb,llvm_ad_rgb]
    efficiency.py scans [--runs R] [--size N]

All programs run by turns on one core, with one thread, so that whatever else the machine does falls
on all of them. Tables in Markdown: medians, and the range of the runs in brackets.

`paths`: a SCENE is a case, such as fog/rate-0.1. Each run has a seed of its own. The error is the
mean over pixels and channels of (x - ref)^2 / (ref^2 + 0.01^2), the reference being the golden, or
the EXR of --reference, whose own noise is subtracted. Efficiency is 1 / (error x CPU seconds).
Neither start, loading, compiling nor writing counts: volref's time is the CPU time of a run less that
of a run of 2 samples; of Mitsuba, that of `render` on a loaded scene, the first call left out.

`scans`: a volume full of fractal noise, 512 x 512 pixels, half a voxel between samples, without and
with shading, to the end and up to a transmittance of 0.004, as VTK always does. Seconds per image:
volref's own, gradients and blocks included; VTK's of a frame after the first, so that its tables and
gradients do not count.

Needs Linux, `cargo build --release`, and in Python `numpy` with `mitsuba` (for llvm_ad_rgb also the
library of LLVM) or `vtk`.
"""

import argparse
import json
import os
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
try:
    import numpy as np
except ImportError:
    sys.exit("numpy is missing: pip install numpy")

DARK = 0.01
CORE = max(os.sched_getaffinity(0))
END = 0.004


def pinned(command, **options):
    """A program that runs on one core only."""
    words = [str(word) for word in command]
    return subprocess.Popen(
        words, preexec_fn=lambda: os.sched_setaffinity(0, {CORE}), text=True, **options
    )


def spread(values, digits=2):
    """Median and range."""
    median, low, high = statistics.median(values), min(values), max(values)
    return f"{median:.{digits}f} ({low:.{digits}f} to {high:.{digits}f})"


class Worker:
    """A renderer in a process of its own, asked line by line."""

    def __init__(self, *arguments):
        command = [sys.executable, Path(__file__).resolve(), "worker", *arguments]
        # VTK complains of a screen that is not there: only of interest if it ends.
        self.complaints = tempfile.TemporaryFile("w+")
        pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE, "stderr": self.complaints}
        self.process = pinned(command, **pipes)

    def ask(self, **question):
        print(json.dumps(question), file=self.process.stdin, flush=True)
        answer = self.process.stdout.readline()
        if not answer:
            self.complaints.seek(0)
            name = " ".join(self.process.args[3:5])
            sys.exit(f"{name} ended without an answer:\n{self.complaints.read()}")
        return json.loads(answer)


# --- Paths ---------------------------------------------------------------------------------------


def mitsuba_worker(variant, scene):
    import drjit as dr
    from run_mitsuba import load, mi, picture

    mi.set_variant(variant)
    # With a pool of one thread, reading an EXR never ends.
    dr.set_thread_count(2)
    scenes = load(scene)
    for line in sys.stdin:
        question = json.loads(line)
        before = time.process_time()
        image = picture(scenes, question["spp"], question["seed"])
        seconds = time.process_time() - before
        np.save(question["output"], image)
        print(json.dumps({"seconds": seconds}), flush=True)


class Reference:
    def __init__(self, image, variance):
        self.image, self.scale = image, image**2 + DARK**2
        self.noise = (variance / self.scale).mean()

    def error(self, image):
        return ((image - self.image) ** 2 / self.scale).mean() - self.noise


class Volref:
    def __init__(self, binary, scene, folder):
        self.binary, self.scene, self.folder = binary, scene, Path(folder)

    def export(self):
        command = [self.binary, "export", self.scene, "--to", "mitsuba", "-o", self.folder, "--json"]
        done = subprocess.run([str(word) for word in command], capture_output=True, text=True)
        if done.returncode:
            sys.exit(f"{self.scene}: Mitsuba cannot be told: {done.stderr}")
        return self.folder / json.loads(done.stdout)["main"]

    def run(self, *options):
        """CPU seconds of a run, what it printed, and where its image is."""
        output = self.folder / "volref.exr"
        command = [self.binary, "render", self.scene, "-o", output, "--threads", 1, "--json", *options]
        process = pinned(command, stdout=subprocess.PIPE)
        printed = process.stdout.read()
        _, status, usage = os.wait4(process.pid, 0)
        if status:
            sys.exit(f"volref render {self.scene} failed")
        return usage.ru_utime + usage.ru_stime, json.loads(printed), output

    def render(self, spp, seed):
        """The image, and CPU seconds of its samples."""
        from image_file import read_exr

        start = self.run("--spp", 2, "--seed", seed)[0]
        seconds, _, output = self.run("--spp", spp, "--seed", seed)
        # Of the whole run, the shorter one also rendered two samples.
        return read_exr(output)[0], (seconds - start) * spp / (spp - 2)


def efficiency(name, options):
    from image_file import read_exr

    scene = ROOT / "fixtures/scenes" / f"{name}.toml"
    with tempfile.TemporaryDirectory() as folder:
        volref = Volref(options.volref, scene, folder)
        exported = volref.export()
        reference = Reference(*read_exr(options.reference or ROOT / "golden" / f"{name}.exr"))
        workers = {variant: Worker("mitsuba", variant, exported) for variant in options.variants}
        output = str(Path(folder) / "mitsuba.npy")
        for worker in workers.values():
            worker.ask(spp=options.spp, seed=0, output=output)
        costs = {who: [] for who in ["volref", *workers]}
        for seed in range(options.seed + 1, options.seed + options.runs + 1):
            image, seconds = volref.render(options.spp, seed)
            costs["volref"].append((reference.error(image), seconds))
            for variant, worker in workers.items():
                answer = worker.ask(spp=options.spp, seed=seed, output=output)
                costs[variant].append((reference.error(np.load(output)), answer["seconds"]))
        cells = [name]
        for variant in workers:
            pairs = zip(costs["volref"], costs[variant])
            cells.append(spread([b * tb / (a * ta) for (a, ta), (b, tb) in pairs]))
        for runs in costs.values():
            error = statistics.median(error for error, _ in runs)
            seconds = statistics.median(seconds for _, seconds in runs)
            cells.append(f"{error:.4f} in {seconds:.2f} s")
        print("| " + " | ".join(cells) + " |", flush=True)


def paths(options):
    from run_mitsuba import mi

    print(f"{options.spp} samples per pixel, {options.runs} runs, Mitsuba {mi.__version__}\n")
    columns = [f"volref / `{variant}`" for variant in options.variants]
    columns += [f"{who}: error, CPU time" for who in ["volref", *options.variants]]
    print("| scene | " + " | ".join(columns) + " |")
    print("| --- |" + " --- |" * len(columns))
    for name in options.scene:
        efficiency(name, options)


# --- Scans ---------------------------------------------------------------------------------------


def noise(points, seed):
    """Value noise between 0 and 1 at points of the unit lattice."""
    whole = np.floor(points).astype(np.uint32)
    part = points - whole
    part = part * part * part * (part * (part * 6 - 15) + 10)
    total = 0.0
    for corner in range(8):
        offset = np.array([corner & 1, corner >> 1 & 1, corner >> 2], np.uint32)
        place = (whole + offset[:, None]).astype(np.uint64)
        mixed = place[0] * 73856093 ^ place[1] * 19349663 ^ place[2] * 83492791 ^ np.uint64(seed)
        mixed = (mixed * np.uint64(0x9E3779B97F4A7C15)) ^ (mixed >> np.uint64(29))
        mixed = mixed * np.uint64(0xBF58476D1CE4E5B9)
        value = (mixed >> np.uint64(40)).astype(float) / (1 << 24)
        weight = np.where(offset[:, None] == 1, part, 1 - part).prod(0)
        total = total + weight * value
    return total


def full_volume(size):
    """Fractal noise in [0, 4], 0 in its two outermost layers and in about two fifths of its inside."""
    centres = (np.arange(size) + 0.5) / size
    z, y, x = np.meshgrid(centres, centres, centres, indexing="ij")
    points = np.stack([x.ravel(), y.ravel(), z.ravel()])
    octaves = range(5)
    total = sum(0.5**k * noise(points * 4 * 2**k, k + 1) for k in octaves)
    total = total / sum(0.5**k for k in octaves)
    density = 4 * np.clip((total - 0.42) / 0.3, 0, 1).reshape(size, size, size)
    inside = np.zeros_like(density)
    inside[2:-2, 2:-2, 2:-2] = 1
    return (density * inside).astype("<f4")


# Value as a part of the largest, colour, opacity over four voxels.
POINTS = [
    (0, (0.2, 0.3, 0.8), 0),
    (0.05, (0.2875, 0.375, 0.8125), 0),
    (0.4, (0.9, 0.9, 0.9), 0.3 * 0.35 / 0.45),
    (0.5, (0.9166666666666666, 0.825, 0.7666666666666667), 0.3),
    (1, (1, 0.45, 0.1), 0.8),
]
VIEW = {"eye": (1.9, 1.3, -1.6), "target": (0.5, 0.5, 0.5), "up": (0, 1, 0)}
PIXELS, ANGLE = 512, 40


def scan_scene(folder, size, top, shaded, ends):
    rows = "\n".join(
        f"    {{ value = {value * top!r}, colour = {list(colour)}, opacity = {opacity} }},"
        for value, colour, opacity in POINTS
    )
    camera = "\n".join(f"{key} = {list(value)}" for key, value in VIEW.items())
    file = folder / f"{'shaded' if shaded else 'unshaded'}{'-ends' if ends else ''}.toml"
    file.write_text(
        f"[film]\nwidth = {PIXELS}\nheight = {PIXELS}\n[camera]\n{camera}\nvertical_fov = {ANGLE}\n"
        + '[classified]\nstep = "0.5 voxels"\n'
        + (f"early_termination = {END}\n" if ends else "")
        + '[classified.volume]\nfile = "full.nrrd"\n'
        + ("[classified.phong]\n" if shaded else "")
        + f'[transfer_function]\nreference_length = "4 voxels"\npoint = [\n{rows}\n]\n'
    )
    return file


def vtk_worker(volume):
    import vtk
    from vtk.util import numpy_support

    density = np.load(volume)
    top, spacing = float(density.max()), 1 / (density.shape[0] - 1)
    values = np.round(density / top * 65535).astype(np.uint16)
    image = vtk.vtkImageData()
    image.SetDimensions(*reversed(values.shape))
    image.SetSpacing(spacing, spacing, spacing)
    image.GetPointData().SetScalars(numpy_support.numpy_to_vtk(values.ravel(), deep=1))
    colour, opacity = vtk.vtkColorTransferFunction(), vtk.vtkPiecewiseFunction()
    for value, rgb, over_four_voxels in POINTS:
        colour.AddRGBPoint(value * 65535, *rgb)
        opacity.AddPoint(value * 65535, over_four_voxels)
    look = vtk.vtkVolumeProperty()
    look.SetColor(colour)
    look.SetScalarOpacity(opacity)
    look.SetScalarOpacityUnitDistance(4 * spacing)
    look.SetInterpolationTypeToLinear()
    mapper = vtk.vtkFixedPointVolumeRayCastMapper()
    mapper.SetInputData(image)
    mapper.AutoAdjustSampleDistancesOff()
    mapper.LockSampleDistanceToInputSpacingOff()
    mapper.IntermixIntersectingGeometryOff()
    mapper.SetImageSampleDistance(1)
    mapper.SetSampleDistance(0.5 * spacing)
    mapper.SetInteractiveSampleDistance(0.5 * spacing)
    mapper.SetNumberOfThreads(1)
    volume = vtk.vtkVolume()
    volume.SetMapper(mapper)
    volume.SetProperty(look)
    renderer = vtk.vtkRenderer()
    renderer.AddVolume(volume)
    window = vtk.vtkRenderWindow()
    window.SetOffScreenRendering(1)
    window.SetMultiSamples(0)
    window.SetSize(PIXELS, PIXELS)
    window.AddRenderer(renderer)
    camera = renderer.GetActiveCamera()
    camera.SetPosition(*VIEW["eye"])
    camera.SetFocalPoint(*VIEW["target"])
    camera.SetViewUp(*VIEW["up"])
    camera.SetViewAngle(ANGLE)
    renderer.ResetCameraClippingRange()
    for line in sys.stdin:
        look.SetShade(int(json.loads(line)["shaded"]))
        window.Render()  # tables and gradients
        mapper.Modified()
        volume.Modified()
        before = time.perf_counter()
        window.Render()
        seconds = time.perf_counter() - before
        version = vtk.vtkVersion.GetVTKVersion()
        print(json.dumps({"seconds": seconds, "version": version}), flush=True)


def scans(options):
    density = full_volume(options.size)
    top = float(density.max())
    with tempfile.TemporaryDirectory() as folder:
        folder = Path(folder)
        np.save(folder / "full.npy", density)
        count, spacing = options.size, 1 / (options.size - 1)
        header = (
            f"NRRD0004\ntype: float\ndimension: 3\nsizes: {count} {count} {count}\n"
            f"spacings: {spacing!r} {spacing!r} {spacing!r}\nendian: little\nencoding: raw\n\n"
        )
        (folder / "full.nrrd").write_bytes(header.encode() + density.tobytes())
        kinds = [(shaded, ends) for shaded in (False, True) for ends in (False, True)]
        scenes = {kind: scan_scene(folder, count, top, *kind) for kind in kinds}
        vtk = Worker("vtk", folder / "full.npy")
        times = {kind: [] for kind in kinds}
        for _ in range(options.runs):
            for shaded in (False, True):
                answer = vtk.ask(shaded=shaded)
                for ends in (False, True):
                    volref = Volref(options.volref, scenes[shaded, ends], folder)
                    seconds = volref.run()[1]["seconds"]
                    times[shaded, ends].append((seconds, answer["seconds"]))
        print(f"{count} x {count} x {count} voxels, {options.runs} runs, VTK {answer['version']}\n")
        print("| image | volref, s | VTK, s | volref / VTK |")
        print("| --- | --- | --- | --- |")
        for (shaded, ends), runs in times.items():
            name = f"{'shaded' if shaded else 'unshaded'}, {'early end' if ends else 'to the end'}"
            ours, theirs = ([run[who] for run in runs] for who in (0, 1))
            ratio = [a / b for a, b in runs]
            print(f"| {name} | {spread(ours)} | {spread(theirs)} | {spread(ratio)} |")


def main():
    if sys.argv[1:2] == ["worker"]:
        {"mitsuba": mitsuba_worker, "vtk": vtk_worker}[sys.argv[2]](*sys.argv[3:])
        return
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--volref", type=Path, default=ROOT / "target/release/volref")
    modes = parser.add_subparsers(dest="mode", required=True)
    mode = modes.add_parser("paths")
    mode.add_argument("scene", nargs="+")
    mode.add_argument("--spp", type=int, default=16)
    mode.add_argument("--runs", type=int, default=5)
    mode.add_argument("--seed", type=int, default=0)
    mode.add_argument("--reference", type=Path, help="another reference, of a single scene")
    mode.add_argument("--variants", type=lambda names: names.split(","),
                      default=["scalar_rgb", "llvm_ad_rgb"])
    mode = modes.add_parser("scans")
    mode.add_argument("--runs", type=int, default=5)
    mode.add_argument("--size", type=int, default=128, help="voxels along each axis [128]")
    options = parser.parse_args()
    if not os.access(options.volref, os.X_OK):
        sys.exit(f"there is no {options.volref}: `cargo build --release` makes it")
    {"paths": paths, "scans": scans}[options.mode](options)


if __name__ == "__main__":
    main()
