"""Settings of the service, read from the environment."""

from __future__ import annotations

from ikplan_api.settings.service import Settings, load_settings, unknown_variables

__all__ = ["Settings", "load_settings", "unknown_variables"]
