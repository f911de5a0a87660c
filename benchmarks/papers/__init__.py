"""The experiments of the three papers, run again: ``python -m benchmarks.papers E1 ... E9``.

[S] Slim et al., Robotics 2023, 12, 38; [K] Kanagaraj et al., MENDEL 2022, 28(1), 41-54; [L] Li,
Luo, Qiao, Machines 2023, 11, 648.
"""
