"""Archive the rows behind the report, and hold rows made anew to it.

``python -m benchmarks.papers.archive write`` packs every row into ``OUT/rows.tar.zst`` and writes
what is committed: ``archive/manifest.json``, the SHA-256 of the rows of every series, of other
seeds too as far as there are, ``archive/medians.npz``, the median of each target and the mean and
maximum of each run, and ``archive/claims.json``, the claims of every seed. ``verify`` compares rows
with the manifest: times are left out of the digests, all else must be equal; where only the last
digits differ, as on another processor, the figures must be. ``hold`` takes the claims of other
seeds, as far as OUT has any, into ``archive/claims.json`` and renews the summary of the committed
report, which prints verdicts that another seed turns as undecided.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import re
import sys
import tarfile
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np
import zstandard

from benchmarks.papers.claims import Claim
from benchmarks.papers.figures_kept import figures_of, same_figures
from benchmarks.papers.report import ORDER
from benchmarks.papers.rows import COLUMNS
from benchmarks.papers.runner import rows_of
from benchmarks.papers.summary import HEADING, OWN, Seeds, read_seeds, summary

__all__ = ["digest_of", "hold", "main", "manifest_of", "read_archived_claims", "verify"]

HERE = Path(__file__).parent / "archive"
REPORT = HERE.parent / "REPORT.md"
TIMES = [i for i, c in enumerate(COLUMNS) if c.endswith("seconds")]


def digest_of(paths: list[Path]) -> str:
    """Return the SHA-256 of the rows of some runs, without the times they took."""
    digest = hashlib.sha256()
    for path in paths:
        for line in path.read_text().splitlines():
            fields = line.split(",")
            digest.update(",".join(f for i, f in enumerate(fields) if i not in TIMES).encode())
    return digest.hexdigest()


def manifest_of(out: Path) -> dict[str, dict[str, object]]:
    """Return runs and digest of every series that has rows, by "case/series"."""
    made: dict[str, dict[str, object]] = {}
    for name in ORDER:
        for label, paths in rows_of(name, out):
            if paths:
                made[label] = {"runs": len(paths), "sha256": digest_of(paths)}
    return made


def verify(
    out: Path,
    manifest: Mapping[str, Mapping[str, object]],
    kept: Mapping[str, np.ndarray] | None = None,
) -> tuple[list[str], list[str]]:
    """Hold rows to the manifest, and where they are others to the figures kept; missing ones pass.

    The last digits of numpy's sines differ from one family of processors to another, and with them
    those of all rows.

    Args:
        out: Folder of the rows.
        manifest: Runs and digest of every series, by "case/series".
        kept: The figures of the report, by "case/series/figure"; None: of no series.

    Returns:
        The series with other rows, but the same figures where these are kept; and what is wrong,
        one line a series.
    """
    rounded, wrong = [], []
    for label, paths in dict(pair for name in ORDER for pair in rows_of(name, out)).items():
        if label not in manifest or not paths:
            continue
        runs = int(str(manifest[label]["runs"]))
        if len(paths) < runs:
            wrong.append(f"{label}: {len(paths)} of {runs} runs")
        elif digest_of(paths[:runs]) != manifest[label]["sha256"]:
            if kept is None or same_figures(label, paths[:runs], kept):
                rounded.append(label)
            else:
                wrong.append(f"{label}: other rows")
    return rounded, wrong


def _figures(out: Path) -> dict[str, np.ndarray]:
    arrays: dict[str, np.ndarray] = {}
    for name in ORDER:
        for label, paths in rows_of(name, out):
            if paths and f"{label}/runs" not in arrays:
                arrays.update(figures_of(label, paths))
    return arrays


def _pack(out: Path, target: Path) -> str:
    """Pack the rows, always in the same order, and return the SHA-256 of the archive."""
    seen = set()
    with (
        target.open("wb") as file,
        zstandard.ZstdCompressor(6).stream_writer(file) as packed,
        tarfile.open(fileobj=packed, mode="w|") as archive,
    ):
        for name in ORDER:
            for _, paths in rows_of(name, out):
                for path in paths:
                    if path not in seen:
                        seen.add(path)
                        archive.add(path, path.relative_to(out).as_posix())
    return hashlib.sha256(target.read_bytes()).hexdigest()


def read_archived_claims() -> dict[str, dict[str, list[Claim]]]:
    """Read the claims behind the committed report, by seed and experiment."""
    kept = json.loads((HERE / "claims.json").read_text())
    return {
        seed: {name: [Claim(**row) for row in rows] for name, rows in claims.items()}
        for seed, claims in kept.items()
    }


def _write_claims(seeds: Seeds) -> None:
    kept = {
        seed: {name: [asdict(c) for c in claims] for name, claims in sorted(by_name.items())}
        for seed, by_name in sorted(seeds.items())
    }
    (HERE / "claims.json").write_text(json.dumps(kept, indent=1) + "\n")


def hold(report: str, made: Seeds) -> tuple[str, Seeds]:
    """Hold the committed report to claims of other seeds.

    Args:
        report: The Markdown.
        made: Claims by seed and experiment; those of the report's own seed are passed over.

    Returns:
        The report with its summary made anew, and the claims of all seeds.

    Raises:
        ValueError: A seed does not have a claim of the report: it is of another version.
    """
    seeds: dict[str, Mapping[str, Sequence[Claim]]] = {**read_archived_claims()}
    for seed, claims in made.items():
        if seed != OWN:
            seeds[seed] = {**seeds.get(seed, {}), **claims}
    head, found, rest = re.split(rf"^(## {HEADING}\n.*?)(?=^## )", report, flags=re.M | re.S)
    del found
    return f"{head}{summary(seeds, ORDER)}\n{rest}", seeds


def main() -> None:
    """Write or verify."""
    parser = argparse.ArgumentParser(
        prog="python -m benchmarks.papers.archive", description=__doc__
    )
    parser.add_argument("what", choices=["write", "verify", "hold"])
    parser.add_argument("--out", type=Path, default=Path("out/papers"), help="folder of the rows")
    options = parser.parse_args()
    if options.what == "hold":
        text, claims = hold(REPORT.read_text(), read_seeds(options.out / "sections"))
        REPORT.write_text(text)
        _write_claims(claims)
        print(f"{REPORT}, {HERE / 'claims.json'}")
        return
    if options.what == "write":
        HERE.mkdir(exist_ok=True)
        packed = options.out / "rows.tar.zst"
        head = {"archive": packed.name, "sha256": _pack(options.out, packed)}
        seeds = {f.name: manifest_of(f) for f in sorted(options.out.glob("seed-*"))}
        document = {"rows": head, "series": manifest_of(options.out), "seeds": seeds}
        (HERE / "manifest.json").write_text(json.dumps(document, indent=0, sort_keys=True) + "\n")
        _write_claims(read_seeds(options.out / "sections"))
        arrays: Any = _figures(options.out)
        np.savez_compressed(HERE / "medians.npz", **arrays)
        print(f"{packed}, {HERE}")
        return
    if not (HERE / "manifest.json").is_file():
        parser.error("there is no archive/manifest.json: `write` makes it from the rows")
    manifest = json.loads((HERE / "manifest.json").read_text())
    rounded, wrong = verify(options.out, manifest["series"], np.load(HERE / "medians.npz"))
    for seed, series in manifest["seeds"].items():
        others, missing = verify(options.out / seed, series)
        wrong += [f"{seed}: {line}" for line in missing]
        if others:
            print(f"{len(others)} series of {seed} with other rows; their figures are not kept")
    if rounded:
        print(f"{len(rounded)} series with other last digits, and the figures of the report")
    print("\n".join(wrong) or "the rows are those of the report")
    sys.exit(bool(wrong))


if __name__ == "__main__":
    main()
