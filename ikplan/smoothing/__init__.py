"""Smooth curves within a tolerance of points."""

from ikplan.smoothing.box_fit import fit_within
from ikplan.smoothing.clusters import Clusters, clusters_of

__all__ = ["Clusters", "clusters_of", "fit_within"]
