#!/usr/bin/env python3
"""Bakes mesh files one after the other as obstacles and prints what each bake says about itself, in voxels.

    tools/bench/bake_files.py --bake build/release/libexec/tact/tact-bake --cells 256 FILE_OR_FOLDER...
"""
import argparse
import json
import pathlib
import subprocess
import tempfile

FORMATS = {".obj", ".stl", ".ply", ".off", ".gltf", ".glb", ".dae"}
ROW = "{:<28} {:>9} {:>5} {:>8} {:>8} {:>6} {:>9} {:>8}"


def files_of(paths):
    for path in paths:
        below = sorted(path.iterdir()) if path.is_dir() else [path]
        yield from (f.resolve() for f in below if f.suffix.lower() in FORMATS)


def bake(program, mesh, cells):
    """The report, or the last line of what the bake said when it refused."""
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        scene = folder / "scene.toml"
        scene.write_text(f'title = "one mesh"\n[obstacle]\nmesh = {json.dumps(str(mesh))}\nunit = "mm"\n'
                         f'field_cells = {cells}\n[tool]\nshape = "sphere"\n')
        done = subprocess.run([program, "--scene", scene, "--cache", folder / "cache", "--part", "obstacle"],
                              capture_output=True, text=True, errors="replace")
        reports = list((folder / "cache").glob("*.json"))
        if done.returncode < 0:
            return f"CRASHED: signal {-done.returncode}"
        if done.returncode != 0 or not reports:
            return (done.stderr.strip().splitlines() or ["said nothing"])[-1]
        return json.loads(reports[0].read_text())


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--bake", type=pathlib.Path, required=True, help="the program tact-bake")
    parser.add_argument("--cells", type=int, default=256, help="along the longest side")
    parser.add_argument("paths", type=pathlib.Path, nargs="+")
    options = parser.parse_args()
    print(ROW.format("mesh", "triangles", "open", "rms", "largest", "jumps", "doubtful", "seconds"))
    names = ("closed", "with holes that were capped", "with open parts")
    groups = {name: [] for name in names}
    refused = 0
    for mesh in files_of(options.paths):
        report = bake(options.bake, mesh, options.cells)
        if isinstance(report, str):
            refused += 1
            print(f"{mesh.name:<28} {report}", flush=True)
            continue
        field, soup = report["field"], report["soup"]
        # null: nothing could be measured
        rms, largest = (field[k] / field["voxel_m"] if field[k] is not None else float("nan")
                        for k in ("error_rms_m", "error_largest_m"))
        doubtful = field["doubtful_blocks"] / max(1, field["blocks_stored"])
        group = names[2 if soup["open_components"] else 1 if soup["capped_holes"] else 0]
        groups[group].append((rms, largest, field["jumping_blocks"], doubtful, field["sign_mismatches"]))
        print(ROW.format(mesh.name, soup["triangles_kept"], soup["open_components"], f"{rms:.4f}", f"{largest:.3f}",
                         field["jumping_blocks"], f"{100 * doubtful:.1f} %", f"{report['seconds']:.1f}"), flush=True)
    for name, rows in groups.items():
        if not rows:
            continue
        rms, largest, jumps, doubtful, mismatches = zip(*rows)
        rms, largest = ([x for x in xs if x == x] or [float("nan")] for xs in (rms, largest))
        print(f"{len(rows)} {name}: rms error {min(rms):.4f} to {max(rms):.4f} voxels, largest {max(largest):.3f}; "
              f"{sum(j > 0 for j in jumps)} with jumps, {sum(d > 0 for d in doubtful)} with doubtful blocks, "
              f"{sum(m > 0 for m in mismatches)} with samples of the other sign")
    print(f"{refused} refused")


if __name__ == "__main__":
    main()
