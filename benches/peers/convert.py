#!/usr/bin/env python3
"""Turn a peers' scene into one for Huygens: convert.py FOLDER [-o FILE.toml]

FOLDER holds scene.json and its PLY files (a neutral form that any renderer can read). Written is
FOLDER/huygens.toml, or FILE, which names the PLY files where they lie. Nothing is approximated: the
film's filter is one pixel's box, `bounces` is the largest number of scattering events, roulette is
off. What has no counterpart stops the conversion with exit code 2.

The neutral form: name; res (pixels each way); spp; bounces; camera (origin, target, up, fov in
degrees across); env (radiance from all around, or null); shapes, each with file, mat (diffuse: rgb;
glass: ior; metal: eta, k and alpha, the GGX width) and perhaps emit (radiance to the front).
"""
import argparse
import json
import os
import sys


def material(mat):
    """Lines of a material's table; a diffuse one is what `albedo` says."""
    kind = mat["kind"]
    if kind == "diffuse":
        return [f"albedo = {mat['rgb']}"]
    if kind == "glass":
        return ['kind = "dielectric"', f"ior = {mat['ior']}"]
    if kind == "metal":
        # The scene format's roughness is the square root of the GGX width. The peers' facets scatter
        # once.
        return ['kind = "conductor"', "compensation = false", f"eta = {mat['eta']}", f"k = {mat['k']}",
                f"roughness = {mat['alpha'] ** 0.5!r}"]
    raise ValueError(f"a material of kind {kind!r} has no counterpart yet")


def convert(scene, folder):
    """The scene as TOML; names of files relative to `folder` are made so that they can be found."""
    camera = scene["camera"]
    out = [
        f"name = {json.dumps(scene['name'])}",
        "",
        "[camera]",
        *(f"{key} = {camera[key]}" for key in ("origin", "target", "up", "fov")),
        "",
        "[film]",
        f"width = {scene['res']}",
        f"height = {scene['res']}",
        'filter = "box"',
        "",
        "[settings]",
        f"spp = {scene['spp']}",
        f"max_depth = {scene['bounces']}",
        "roulette = false",
    ]
    if scene["env"]:
        out += ["", "[sky]", f"radiance = {scene['env']}"]
    for shape in scene["shapes"]:
        out += ["", f"[materials.{shape['name']}]", *material(shape["mat"])]
        if shape.get("emit"):
            out.append(f"emission = {shape['emit']}")
    for shape in scene["shapes"]:
        path = os.path.join(folder, shape["file"])
        out += ["", "[[shapes]]", f"ply = {json.dumps(path)}", f"material = {json.dumps(shape['name'])}"]
    return "\n".join(out) + "\n"


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder")
    parser.add_argument("-o", "--out")
    args = parser.parse_args()
    out = args.out or os.path.join(args.folder, "huygens.toml")
    try:
        with open(os.path.join(args.folder, "scene.json"), encoding="utf-8") as f:
            scene = json.load(f)
        text = convert(scene, os.path.relpath(args.folder, os.path.dirname(os.path.abspath(out))))
    except (OSError, ValueError, KeyError) as error:
        print(f"convert.py: {args.folder}: {error}", file=sys.stderr)
        sys.exit(2)
    with open(out, "w", encoding="utf-8") as f:
        f.write(text)


if __name__ == "__main__":
    main()
