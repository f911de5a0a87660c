"""The board and the alerts name metrics that the service has."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

import pytest
import yaml

from ikplan_api.app import create_app
from ikplan_api.settings import Settings

ROOT = Path(__file__).parents[2]
BOARD: dict[str, Any] = json.loads((ROOT / "docker/grafana.json").read_text())
ALERTS: dict[str, Any] = yaml.safe_load((ROOT / "docker/alerts.yaml").read_text())
FLEET: dict[str, Any] = yaml.safe_load((ROOT / "docker/compose.fleet.yaml").read_text())
QUERIES = {
    **{
        f"{panel['title']} {target['refId']}": target["expr"]
        for panel in BOARD["panels"]
        for target in panel["targets"]
    },
    **{rule["alert"]: rule["expr"] for group in ALERTS["groups"] for rule in group["rules"]},
}
OF_PROMETHEUS = {"up"}


def known() -> dict[str, str]:
    """Every metric by its name, with its kind."""
    text = create_app(Settings(store_path=":memory:")).state.metrics.text().decode()
    return dict(re.findall(r"^# TYPE (\S+) (\S+)$", text, re.MULTILINE))


KNOWN = known()


def named(query: str) -> set[str]:
    without_labels = re.sub(r"\{[^}]*\}|by \([^)]*\)|\[[^]]*\]", "", query)
    words = re.findall(r"[a-z_]+(?=[^a-z_(]|$)", without_labels)
    return {word for word in words if "_" in word or word == "up"} - {"histogram_quantile"}


@pytest.mark.parametrize("title", sorted(QUERIES))
def test_every_metric_of_a_query_exists(title: str) -> None:
    metrics = named(QUERIES[title]) - OF_PROMETHEUS
    assert metrics or "up" in QUERIES[title]
    for name in metrics:
        base = re.sub(r"_(bucket|count|sum)$", "", name)
        kind = KNOWN.get(name) or KNOWN.get(base)
        assert kind is not None, name
        assert (kind == "histogram") == (name != base or name not in KNOWN), name


def test_a_metric_that_does_not_exist_would_be_seen() -> None:
    assert named("sum(rate(ikplan_none_total[5m])) > 1") == {"ikplan_none_total"}
    assert "ikplan_none_total" not in KNOWN


@pytest.mark.parametrize("kind", ["counter", "histogram"])
def test_a_counter_is_asked_for_its_rate(kind: str) -> None:
    for title, query in QUERIES.items():
        for name in named(query) - OF_PROMETHEUS:
            if KNOWN.get(re.sub(r"_(bucket|count|sum)$", "", name)) == kind:
                assert re.search(rf"rate\({name}[{{\[]", query), title


def test_panels_have_ids_and_places_of_their_own() -> None:
    ids = [panel["id"] for panel in BOARD["panels"]]
    places = [(panel["gridPos"]["x"], panel["gridPos"]["y"]) for panel in BOARD["panels"]]
    assert len(set(ids)) == len(ids)
    assert len(set(places)) == len(places)


def test_the_fleet_of_compose_sets_what_the_service_knows() -> None:
    known_names = {f"IKPLAN_{name}".upper() for name in Settings.model_fields}
    service = FLEET["services"]["ikplan"]
    assert set(service["environment"]) <= known_names
    assert service["deploy"]["replicas"] == 2
    assert service["build"]["args"]["EXTRAS"] == "postgres"
    assert all(port.startswith("127.0.0.1:") for port in service["ports"])
    assert service["cap_drop"] == ["ALL"]
    assert service["read_only"] is True
    assert int(service["stop_grace_period"].removesuffix("s")) >= Settings().stop_s + 5
