"""Radii on the processor and by compute shaders, by points per chunk (as figures 5.12 and 5.13 of the source): a table in Markdown.

    python3 bench/neighbours/gpu_radii.py --bin build/release/bin --work /tmp/radii --points 500000 --rounds 3
"""

import argparse
import json
import pathlib
import subprocess

CHUNKS = [2000, 3000, 5000, 7000, 11000, 25000, 50000, 100000]


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--bin", type=pathlib.Path, required=True, help="folder of pcmlab and bench_gpu_radii")
    parser.add_argument("--work", type=pathlib.Path, required=True, help="folder for the clouds")
    parser.add_argument("--points", type=int, default=500000)
    parser.add_argument("--neighbours", type=int, default=16)
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--chunks", type=lambda text: [int(n) for n in text.split(",")], default=CHUNKS)
    parser.add_argument("--l1", type=int, default=512, help="MB")
    options = parser.parse_args()
    options.work.mkdir(parents=True, exist_ok=True)

    def run(program, *words):
        return subprocess.run([options.bin / program, *map(str, words)], check=True, capture_output=True, text=True).stdout

    las = options.work / "scene.las"
    run("pcmlab", "generate", "-q", "--overwrite", "--no-truth", "-n", options.points, las)
    print("| points per chunk | normals | CPU, s | GPU, s | CPU, processor s | GPU, processor s | largest difference | ties |\n|---|---|---|---|---|---|---|---|")
    device = ""
    for chunk in options.chunks:
        tree, with_normals = options.work / "scene.pct", options.work / "normals.pct"
        run("pcmlab", "build", "-q", "--overwrite", "--chunk-points", chunk, las, "-o", tree)
        subprocess.run(["rm", "-rf", with_normals], check=True)
        run("pcmlab", "normals", "-q", tree, "-o", with_normals)
        for name, cloud, words in (("no", tree, []), ("yes", with_normals, ["--normals"])):
            row = json.loads(run("bench_gpu_radii", cloud, "-k", options.neighbours, "--rounds", options.rounds, "--l1", options.l1, *words))
            device = row["device"]
            print(f"| {chunk} | {name} | {row['cpu_seconds']:.2f} | {row['gpu_seconds']:.2f} | {row['cpu_processor_seconds']:.2f} | "
                  f"{row['gpu_processor_seconds']:.2f} | {row['largest_difference']:.1e} | {row['ties']} |", flush=True)
    print(f"\n{options.points} points, k = {options.neighbours}, medians of {options.rounds}; {device}")


if __name__ == "__main__":
    main()
