#!/usr/bin/env python3
"""Whole renderers side by side; renderers.sh starts it.

For each scene, rounds in which every renderer makes one image, in turn and each round beginning with
another, with a seed of the round's own. All walk the same path lengths (no roulette).

Rate: camera paths a CPU second of rendering (loading, building, compiling left out); the ratio is
the median over rounds of ratios within a round, with its range.
Error: the variance of a renderer's pixels over rounds, estimated without a reference; efficiency is 1 /
(variance relative to the squared image, median over pixels, times CPU seconds), the error at equal
CPU time.
Agreement: the means of the images differ by less than 0.2%, and by less than chance explains: z is the
difference over its standard error, from tiles of 16 x 16 pixels, each of which is an independent estimate.
"""
import argparse
import json
import os
import statistics
import subprocess
import sys

import numpy as np
import OpenEXR

HERE = os.path.dirname(os.path.abspath(__file__))
# Two-sided significance of 0.1% over the comparisons of one run, Bonferroni: at most
# 3 scenes x 5 peers, 0.001 / 15 = 6.7e-5, |z| = 3.99.
Z_LIMIT = 3.99
MEAN_LIMIT = 0.002


def read(path):
    """An EXR file's RGB as an array of height x width x 3."""
    with OpenEXR.File(path) as f:
        channels = f.channels()
        for name in ("RGB", "RGBA"):
            if name in channels:
                return np.asarray(channels[name].pixels, np.float64)[..., :3]
        for prefix in ("", "Combined.", "ViewLayer.Combined."):
            if prefix + "R" in channels:
                columns = [np.asarray(channels[prefix + c].pixels, np.float64) for c in "RGB"]
                return np.stack(columns, -1)
    sys.exit(f"{path}: no RGB channels")


def tiles(image, edge=16):
    """Mean luminance of each whole tile."""
    height, width = (n // edge * edge for n in image.shape[:2])
    grey = image[:height, :width].mean(-1)
    return grey.reshape(height // edge, edge, width // edge, edge).mean((1, 3)).ravel()


class Huygens:
    """This renderer."""

    name = "huygens"

    def __init__(self, args):
        self.program = args.huygens
        self.options = args.options

    def scene(self, folder):
        """Why it cannot render the scene, or None."""
        convert = [sys.executable, os.path.join(HERE, "convert.py"), folder]
        done = subprocess.run(convert, capture_output=True, text=True)
        if done.returncode:
            return done.stderr.strip()
        # What cannot be rendered is refused at any size.
        look = [self.program, "render", os.path.join(folder, "huygens.toml"), "--quiet", "--size", "1x1",
                "--spp", "1", "-o", os.path.join(folder, "huygens-look.exr")]
        done = subprocess.run(look, capture_output=True, text=True)
        return done.stderr.strip() if done.returncode else None

    def render(self, folder, spp, seed, threads, out):
        """Renders; returns camera paths and CPU seconds."""
        stats = out + ".json"
        command = [self.program, "render", os.path.join(folder, "huygens.toml"), "--quiet",
                   "--roulette", "off", "--spp", str(spp), "--seed", str(seed),
                   "--threads", str(threads), "--stats", stats, "-o", out, *self.options]
        subprocess.run(command, check=True)
        with open(stats, encoding="utf-8") as f:
            numbers = json.load(f)
        return numbers["samples"]["done"], numbers["seconds"]["render_cpu"]


class Peer:
    """One of the renderers that run.py knows."""

    def __init__(self, name, args):
        self.name = name
        self.run = os.path.join(args.peers, "run.py")

    def scene(self, folder):
        del folder

    def render(self, folder, spp, seed, threads, out):
        """Renders; returns camera paths and CPU seconds."""
        command = [sys.executable, self.run, os.path.basename(folder), self.name, "--rr", "off",
                   "--spp", str(spp), "--seed", str(seed), "--threads", str(threads), "--out", out]
        done = subprocess.run(command, capture_output=True, text=True)
        if done.returncode:
            sys.exit(f"{self.name} failed on {folder}:\n{done.stderr[-2000:]}")
        numbers = json.loads(done.stdout.splitlines()[-1])
        return numbers["samples"], numbers["render_cpu_s"]


def compare(scene, renderers, args):
    """Renders one scene with all; prints a table; returns Huygens' ratio to each peer, or None."""
    folder = os.path.join(args.root, "scenes", scene)
    for renderer in renderers:
        if (why := renderer.scene(folder)):
            print(f"\n{scene}: {why}")
            return None
    rates = {r.name: [] for r in renderers}
    seconds = {r.name: [] for r in renderers}
    images = {r.name: [] for r in renderers}
    for i in range(args.rounds):
        for renderer in renderers[i % len(renderers):] + renderers[:i % len(renderers)]:
            out = os.path.join(args.root, "out", f"{scene}-{renderer.name}-{i}.exr")
            os.makedirs(os.path.dirname(out), exist_ok=True)
            paths, cpu = renderer.render(folder, args.spp, 7 * i + 1, args.threads, out)
            rates[renderer.name].append(paths / cpu / 1e6)
            seconds[renderer.name].append(cpu)
            images[renderer.name].append(read(out))
    own = renderers[0].name
    floor = 0.01 * np.mean(images[own])
    print(f"\n{scene}: {args.spp} spp, {args.rounds} rounds, no roulette")
    print(f"{'':16}{'Mpaths/CPU s':>14}{'huygens is':>12}{'range':>14}{'efficiency':>12}"
          f"{'mean':>10}{'difference':>12}{'z':>7}")
    efficiency, ratios, mean = {}, {}, {n: np.mean(i, axis=0) for n, i in images.items()}
    for name, of in images.items():
        variance = np.var(of, axis=0, ddof=1) / (mean[name] + floor) ** 2
        efficiency[name] = 1 / (np.median(variance.mean(-1)) * statistics.mean(seconds[name]))
    for name in images:
        ratio = [a / b for a, b in zip(rates[own], rates[name])]
        ratios[name] = statistics.median(ratio)
        difference = tiles(mean[own]) - tiles(mean[name])
        error = difference.std(ddof=1) / len(difference) ** 0.5
        relative = difference.mean() / tiles(mean[name]).mean()
        z = difference.mean() / error if error > 0 else 0.0
        apart = abs(relative) > MEAN_LIMIT or abs(z) > Z_LIMIT
        print(f"{name:16}{statistics.median(rates[name]):14.3f}{ratios[name]:11.2f}x"
              f"{f'{min(ratio):.2f}-{max(ratio):.2f}':>14}{efficiency[own] / efficiency[name]:11.2f}x"
              f"{mean[name].mean():10.5f}{100 * relative:11.3f}%{z:7.1f}"
              f"{'  DISAGREE' if apart else ''}", flush=True)
    return ratios


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--huygens", required=True, help="the program")
    parser.add_argument("--peers", required=True, help="folder of run.py")
    parser.add_argument("--root", required=True, help="where the peers are installed")
    parser.add_argument("--scenes", default="cornell,mesh,glossy")
    parser.add_argument("--with", dest="names", default="mitsuba-llvm",
                        help="peers, as run.py names them; the last line is about the first")
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--spp", type=int, default=16)
    parser.add_argument("--threads", type=int, default=os.cpu_count())
    parser.add_argument("--options", default="--sampler independent", type=str.split,
                        help="further options of huygens render (default: the sampler that "
                             "the peers' scenes ask for)")
    args = parser.parse_args()
    if args.rounds < 2:
        parser.error("variances need two rounds at least")
    peers = [Peer(name, args) for name in args.names.split(",")]
    line = f"ratio {peers[0].name}"
    for scene in args.scenes.split(","):
        ratios = compare(scene, [Huygens(args), *peers], args)
        line += f" {scene} {ratios[peers[0].name]:.2f}" if ratios else f" {scene} n/a"
    print(f"\n{line}")


if __name__ == "__main__":
    main()
