"""D: where the code reads a paper's text in one of several ways, and what each reading does."""

from __future__ import annotations

from dataclasses import replace

from benchmarks.papers.case import Case
from benchmarks.papers.experiment import Study, thinned
from benchmarks.papers.helix import random_targets
from benchmarks.papers.li_poses import pose_case
from benchmarks.papers.series import Series
from benchmarks.papers.trajectories import random_positions

__all__ = ["GROUPS", "RUNS", "studies"]

RUNS = 3
"""Runs of each: the targets are what the tests are over."""
COUNT = 100

Reading = tuple[str, str, dict[str, object]]
"""What the text or the other reading is, its label, and the options that choose it."""


def _group(
    first: str, method: str, size: tuple[int, int], base: dict[str, object], others: list[Reading]
) -> list[tuple[str, Series]]:
    """A default reading, and those compared with it."""
    made = [(first, Series(method.upper(), method, *size, base))]
    for text, label, options in others:
        made.append(
            (text, Series(f"{method.upper()}, {label}", method, *size, {**base, **options}))
        )
    return made


_IK_BA: dict[str, object] = {"preset": "bat-code"}
_BA: dict[str, object] = {}
GROUPS: dict[str, list[list[tuple[str, Series]]]] = {
    "D-iiwa": [
        _group(
            "[S] Eq. 14: 0.1 N(0, 1), as bat code has it",
            "ik-ba",
            (50, 200),
            _IK_BA,
            [
                ("[S] Eq. 14: uniform in [-1, 1)", "uniform", {"preset": "slim"}),
                (
                    "[S] Eq. 14: N(0, 1) within [-1, 1]",
                    "truncated",
                    {"preset": "slim", "noise": "truncated"},
                ),
                (
                    "[S] Eq. 14: N(0, 1/3)",
                    "a third",
                    {"noise": "normal", "eps_scale": 1.0 / 3.0},
                ),
                ("[S] Eq. 14: eps one number a bat", "one eps", {"draws": "bat"}),
                ("[S] Algorithm 2: two candidates a bat", "both", {"variant": "both"}),
                (
                    "[S] Algorithm 2: the same, X_i overwritten by Eq. 14",
                    "overwritten",
                    {"variant": "overwritten"},
                ),
                (
                    "[S] Eq. 5: the same, beta one number a bat",
                    "overwritten, one beta",
                    {"variant": "overwritten", "beta": "bat"},
                ),
                (
                    "[S] Eq. 13 with its sign turned",
                    "both, attract",
                    {"variant": "both_attract"},
                ),
                ("[S] Algorithm 2: x* gated by the loudness", "gated", {"accept": "loudness"}),
            ],
        ),
        _group(
            "[S] Eq. 5 with a vector, Eq. 8 with the mean loudness, x* always kept",
            "ba",
            (50, 200),
            _BA,
            [
                ("[S] Eq. 5: beta one number a bat", "one beta", {"beta": "bat"}),
                ("[S] Eq. 8: A_i of the bat", "own loudness", {"loudness": "own"}),
                ("[S] Algorithm 1: x* of accepted moves only", "x* gated", {"record": "accepted"}),
                ("[S] pulse rate 0 at first", "rate 0", {"rate": "zero"}),
                (
                    "[S] Eq. 6 and Algorithm 1 to the letter",
                    "literal",
                    {
                        "sign": "literal",
                        "accept": "best",
                        "record": "accepted",
                        "loudness": "own",
                    },
                ),
            ],
        ),
        _group(
            "[S] Table 1 permuted",
            "pso",
            (50, 200),
            {"preset": "slim-permuted"},
            [
                ("[S] Table 1 as printed", "as printed", {"preset": "slim"}),
                ("no limit of the velocity", "no v_max", {"v_max": 0.0}),
            ],
        ),
    ],
    "D-mh5": [
        _group(
            "[K] Eq. 7: eps one number a bat",
            "bat",
            (60, 100),
            {},
            [
                ("[K] Eq. 7: eps a vector", "eps a vector", {"noise": "component"}),
                ("loudness falls every iteration", "decay", {"decay": "iteration"}),
                (
                    "circulating bat code",
                    "shared",
                    {
                        "reading": "shared",
                        "A_low": 1.0,
                        "A_high": 1.0,
                        "r0_low": 1.0,
                        "r0_high": 1.0,
                    },
                ),
            ],
        ),
        _group(
            "[K]: r1, r2 one pair a particle",
            "pso",
            (60, 100),
            {"preset": "kanagaraj"},
            [
                ("r1, r2 for every component", "vector draws", {"draws": "component"}),
                ("no limit of the velocity", "no v_max", {"v_max": 0.0}),
            ],
        ),
        _group(
            "[K] Eq. 10 with alpha 1, clipped at the bounds",
            "gsa",
            (60, 100),
            {},
            [
                ("drawn anew at the bounds", "drawn anew", {"bounds": "resample"}),
                ("alpha 20 of Rashedi et al.", "alpha 20", {"alpha": 20.0}),
                (
                    "alpha 20, drawn anew",
                    "alpha 20, drawn anew",
                    {"alpha": 20.0, "bounds": "resample"},
                ),
            ],
        ),
        _group(
            "WOA of Mirjalili and Lewis",
            "woa",
            (60, 100),
            {},
            [("[K] Eqs. 19 and 20 as printed", "literal", {"literal": True})],
        ),
    ],
    "D-eod": [
        _group(
            "[L] Algorithm 2: trials in place, no H",
            "bode-cs",
            (30, 100),
            {},
            [
                (
                    "[L] Eqs. 17 and 28: mutants of x(t)",
                    "synchronous",
                    {"generation": "synchronous"},
                ),
                ("[L] Eq. 29: H(Pa - eps)", "H of Eq. 29", {"heaviside": True}),
                ("[L] Eq. 23 plus Fmin", "F + Fmin", {"scaling": "plus_fmin"}),
            ],
        ),
        _group(
            "[L] Eq. 29 without H",
            "cs",
            (30, 100),
            {},
            [
                ("Yang's and Deb's factor N(0, 1)", "N(0, 1)", {"normal_factor": True}),
                ("[L] Eq. 29: H(Pa - eps)", "H of Eq. 29", {"heaviside": True}),
            ],
        ),
        _group(
            "[L]: F 0.9 at first",
            "sde",
            (30, 100),
            {},
            [("Omran et al.: F drawn", "F drawn", {"F_initial": "normal"})],
        ),
        _group(
            "[L]: inertia 0.9 to 0.4, ours",
            "pso",
            (30, 100),
            {"preset": "li"},
            [("no limit of the velocity", "no v_max", {"v_max": 0.0})],
        ),
    ],
}


def _case(name: str) -> Case:
    """Return 100 random positions of an arm, cold but for the start of what is warm."""
    if name == "D-iiwa":
        return replace(random_targets(COUNT), name=name, title="iiwa 14", stop_value=-1.0)
    if name == "D-mh5":
        return random_positions(name, COUNT)
    return replace(pose_case("E7c", "eod_arm", "EOD arm", 0.0), name=name, stop_value=-1.0)


def studies(thin: int) -> list[Study]:
    """Return one case an arm, with every reading."""
    return [
        Study(
            thinned(_case(name), thin),
            [replace(s, max_runs=RUNS) for group in groups for _, s in group],
        )
        for name, groups in GROUPS.items()
    ]
