"""What the report says first."""

from __future__ import annotations

__all__ = ["CONTRADICTIONS", "DEFAULTS", "FINDINGS", "READING"]

READING = (
    "[S] Slim et al., Robotics 2023, 12, 38 (IK-BA). [K] Kanagaraj et al., MENDEL 2022, 28(1), "
    "41-54 (BAT, GSA, PSO, WOA). [L] Li, Luo, Qiao, Machines 2023, 11(6), 648 (BODE-CS). "
    "Two rows of every comparison are in no paper: `ikplan`, the project's own planner (IK-BA "
    "seeds, refinement, least joint motion), and the true optimum where it can be computed: the "
    "least joint motion found by many restarts on the iiwa and the MH5, the closed form of the "
    "Dobot and of the EOD arm."
)

FINDINGS = """\
## What was found

Figures of the full run, the report committed with the code.

### IK-BA [S]

- **The error is reproduced, with one constant that the paper does not print.** With the noise of Eq. 14
  as printed it is six to seven times as large, on the helix (median) and on the Dobot alike; with 0.15
  of that noise it is the published one on both: 0.0021 cm on E1a (published 0.0019).
- **The first population decides, and is not described.** Drawn over the whole joint range, a run of E1b
  or E1c can begin on a branch on which A1 meets its limit later on. The noise is too small to leave
  it: a few per cent of the solves, with errors of centimetres, then make up the mean (E1b 0.28 cm at a
  median of 0.0021). Drawn around the start, E1c has the published error, 0.0019 cm, without a miss.
- **E1b as a whole stays above the 0.0025 cm asked of it: 0.0049 cm.** At points 7, 16 and 17 the wrist is
  within 2.2 mm of the end of its reach, and the arm all but straight; the other 17 points have 0.0019 cm.
- **The published joint variation, 87 deg, is reproduced** on all three readings with the noise as
  printed: 88, 94 and 99 deg.
- **That IK-BA moves the joints least is due to where it begins, not to its update.** Only IK-BA is told
  where the arm is. Begun around the start as well, BA, DE, PSO and ABC move 40 to 88 deg a point instead
  of 270 to 410, and IK-BA as printed is last or last but one of the six on every reading; DE then has the
  smallest error on E1b and E1c, by two orders of magnitude. (With 0.15 of the noise and the same
  start IK-BA does move least on E1a and E1b, 26 and 42 deg.)
- The published order of the errors is reproduced in its head only on E1a. PSO of [S] has an inertia above
  1 and does not converge from any start: it never gets to 1 mm in E2. MO-PSO moves the joints
  less than IK-BA on E1a and E1b, but misses by 7 mm.
- 7 to 35 % of the decoupled solves break a limit of the wrist, whatever the algorithm; the paper does
  not say so. `wrist_limits: penalise` ends that, at nearly five times the cost.
- **The least possible motion is a quarter (E1a) to two fifths (E1b) of that of IK-BA.** The project's
  planner is within 0.1 % of it, the same planner point by point within 0.2 % (E1a) and 1.4 % (E1b).
- The Dobot's circle is reproduced in full: every angle of Table 8, and errors of the printed size.

### BAT, GSA, PSO, WOA [K]

- **BAT and GSA do not come near their published errors**: as printed they end at about 1e-2 m on every
  trajectory, thousands of times what Table 4 has. Letting the loudness of BAT fall in every iteration
  brings a factor of two to four. GSA with alpha = 20 ends at 1e-10 m or fails by centimetres.
- **PSO and WOA do**, read as printed: PSO with one random number a particle instead of one a
  component, WOA with Eq. 20 as printed, without its absolute value. Both are then at 1e-4 m, as
  published; with the usual PSO the error is ten to a hundred times that.
- So the order of the errors is the published one turned around, on every trajectory, and with it the
  ranking.

### BODE-CS [L]

FINDINGS_L
"""

CONTRADICTIONS = """\
## Published figures that contradict each other

[S] Slim et al. 2023:

- Eq. 27 turns the tool horizontal (z = +y of the base); the text says normal to the floor.
- The helix as described (phase 0) has three points out of reach, which miss by 0.6 to 3 cm; a mean
  error of 0.0019 cm over all 20 is then impossible. A phase or a simplification is not stated.
- 20 individuals in section 5.3.2, 50 in section 5.2, for the same table.
- Times for N = 20: the maximum, 80.06 ms, is below the mean, 83.75 ms. N = 12 is called real time,
  below 50 ms, with a maximum of 67.2 ms.
- Table 8: the 20 errors average 2.55e-14 cm, the text says 2.12e-14. Point 12 is misprinted:
  9.61e-15, not e-14.
- Eq. 13 drives bats away from its target, and Eq. 14 overwrites what Eqs. 7 and 13 made. The
  loudness test of Algorithm 2 cannot have gated x*: at t = 1000 the loudness is 6e-14.
- eps of Eq. 14 is "in [-1, 1] from a normal distribution". Neither gives the published errors; a
  factor of 0.15 on the uniform reading gives both of them.

[K] Kanagaraj et al. 2022:

- Section 4.2 has GSA and PSO reach 0.1e-4 within about 90 iterations, while their mean errors after
  100 iterations, Table 4, are all above that. No unit is given.
- The "mean" of Table 5 is the geometric mean of Table 4. The row of WOA on the rose does not follow
  from Table 4: its maximum there is 7.09, not 6.81.
- The conclusion quotes GSA at 0.08 to 0.26; the smallest mean of the tables is 0.18.
- The average of ranks is called a Wilcoxon test.
- No coordinates of the trajectories are given.

[L] Li et al. 2023:

- BODE-CS on Task 1: 0.070 mm in Table 4, 0.0070 mm in Table 5, below 0.01 mm in the conclusion.
- PSO of Table 4, 14.963 mm with a fitness of 15.213: the difference exceeds what omega_R allows.
- F of Eq. 23 never lies in [Fmin, Fmax]; yet only this form gives the published errors.
- Table 8, Baxter: the fitness of BODE-CS excludes the weight computed for that arm.
- Trajectory 3 is out of reach at x = +500 mm; x = -500 mm was meant.
- Eq. 47 is no rotation (determinant 0.134), and none of its seven repairs by three signs makes all
  points reachable.
- A mean fitness of 0.067 at a mean position error of 0.0006 mm means 75 deg of orientation error.
  The method as published solves the position and all but ignores the orientation.
"""

DEFAULTS = """\
## What the papers leave open, and what was taken

Each is a named option of the solver; `ikplan solvers NAME` or `GET /v1/solvers` lists them all.

| open | taken | option |
| --- | --- | --- |
| positions outside the joint limits | clipped, velocity to zero | `bounds` |
| first population | uniform in the limits, velocities zero | `warm` |
| IK-BA: noise of Eq. 14 | uniform in [-1, 1), factor 1; calibrated 0.15 | `noise`, `eps_scale` |
| IK-BA: which candidates are evaluated | Eq. 14 only | `variant` |
| IK-BA: acceptance | every better candidate | `accept` |
| IK-BA: t of the first iteration | 1 | `first_t` |
| BA: sign of Eq. 6 | towards the best | `sign` |
| BA, BAT: acceptance, decay of loudness | own value; when a bat moves | `accept`, `decay` |
| DE of [S]: strategy | rand/1 | method |
| SDE | Omran et al. 2005, a new factor lives on with its trial | `F_initial` and others |
| ODE: jump rate | 0.3 | `Jr` |
| PSO: limit of the velocity | half of each joint's range | `v_max` |
| PSO of [L]: inertia | 0.9 to 0.4, linear | `w`, `w_end` |
| PSO of [K]: scalar or vector draws | vector | `draws` |
| MO-PSO: reported candidate; archive | smallest position error; 200 | `choice`, `archive` |
| K-ABC | standard ABC in its place | `move`, `fitness`, `fitness_scale` |
| GSA: alpha | 1 as printed; 20 as a control | `alpha` |
| WOA: Eq. 20 | with absolute value and exploration | `literal`, `b` |
| CS: Heaviside factor of Eq. 29 | left out | `heaviside` |
| GA: operators | tournament 2, BLX-0.5, one gene anew, 1 elite | `blend`, `mutation` |
| BODE-CS: Eq. 23; r1, r2, r3 | as printed; may equal j | `scaling`, `exclude_self` |
| Newton-Raphson | pseudoinverse, angles wrapped | `limits`, `damping`, `restarts` |
| wrist limits in the decoupling | ignored, as in [S], and counted | `wrist_limits` |
| omega_R | 0.0384167 in E7 to E9; `objective` bode-cs computes it | `weight_orientation` |
| home of E1; start of E3, E4, E9 | zero; (0, 45, 45) deg; zero; zero | - |
| phase of the helix | 124 deg (E1b), 293 deg (E1c), 0 (E1a, E1d) | - |
| T of E2; N of E3; N, T of E9 | 1000; 50; 60, 100 | - |
| runs of [L] | 20 for E7a; fewer where a section says so | `--runs` |
"""
