"""The entries of the solver registry, with the papers' parameters, by family."""

from __future__ import annotations

from ikplan.ik.catalogue.baselines import BASELINES
from ikplan.ik.catalogue.bats import BATS
from ikplan.ik.catalogue.differential import DIFFERENTIAL
from ikplan.ik.catalogue.evolution import EVOLUTION
from ikplan.ik.catalogue.refinement import REFINEMENT
from ikplan.ik.catalogue.swarms import SWARMS

__all__ = ["CATALOGUE"]

CATALOGUE = [*BATS, *DIFFERENTIAL, *SWARMS, *EVOLUTION, *BASELINES, *REFINEMENT]
