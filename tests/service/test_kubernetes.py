"""The manifest fits Kubernetes, the image and the service, as far as files can tell."""

import re
from pathlib import Path
from typing import Any

import httpx
import kubernetes_validate
import pytest
import yaml

import ikplan
from ikplan_api.settings import Settings
from tests.present import present

ROOT = Path(__file__).parents[2]
OBJECTS = list(yaml.safe_load_all((ROOT / "docker/kubernetes.yaml").read_text()))
BY_KIND = {document["kind"]: document for document in OBJECTS}
POD = BY_KIND["Deployment"]["spec"]["template"]["spec"]
(CONTAINER,) = POD["containers"]
DOCKERFILE = (ROOT / "docker/Dockerfile").read_text()
PORTS = {port["name"]: port["containerPort"] for port in CONTAINER["ports"]}
OLDEST = "1.30"


def from_image(pattern: str) -> str:
    return present(re.search(pattern, DOCKERFILE, re.MULTILINE))[1]


@pytest.mark.parametrize("version", [OLDEST, kubernetes_validate.latest_version()])
@pytest.mark.parametrize("document", OBJECTS, ids=lambda document: document["kind"])
def test_every_object_fits_its_schema(document: dict[str, Any], version: str) -> None:
    kubernetes_validate.validate(document, version, strict=True)


def test_a_misspelt_field_would_be_seen() -> None:
    wrong = {**BY_KIND["Service"], "sepc": {}}
    with pytest.raises(kubernetes_validate.ValidationError):
        kubernetes_validate.validate(wrong, OLDEST, strict=True)


def test_every_kind_is_there_once() -> None:
    assert len(BY_KIND) == len(OBJECTS)
    assert set(BY_KIND) >= {"Deployment", "Service", "HorizontalPodAutoscaler"}


def test_the_probes_ask_for_what_the_service_answers_without_a_key(http: httpx.Client) -> None:
    paths = http.get("/openapi.json").json()["paths"]
    for name in ("startupProbe", "readinessProbe", "livenessProbe"):
        probe = CONTAINER[name]["httpGet"]
        assert probe["port"] in PORTS
        assert probe["path"] in paths
        assert http.get(probe["path"]).status_code == 200
    # To be busy or warming up is no reason to be killed.
    assert CONTAINER["livenessProbe"]["httpGet"]["path"] == "/livez"
    assert CONTAINER["readinessProbe"]["httpGet"]["path"] == "/readyz"


def test_the_ports_meet() -> None:
    assert PORTS["http"] == int(from_image(r"^EXPOSE (\d+)$"))
    (port,) = BY_KIND["Service"]["spec"]["ports"]
    assert port["targetPort"] in PORTS
    (rule,) = BY_KIND["NetworkPolicy"]["spec"]["ingress"]
    assert [port["port"] for port in rule["ports"]] == ["http"]


def test_every_right_is_taken_away() -> None:
    pod, own = POD["securityContext"], CONTAINER["securityContext"]
    assert f"{pod['runAsUser']}:{pod['runAsGroup']}" == from_image(r"^USER (\S+)$")
    assert pod["runAsNonRoot"] is True
    assert pod["fsGroup"] == pod["runAsGroup"]
    assert pod["seccompProfile"] == {"type": "RuntimeDefault"}
    assert own["readOnlyRootFilesystem"] is True
    assert own["allowPrivilegeEscalation"] is False
    assert own["capabilities"] == {"drop": ["ALL"]}
    assert POD["automountServiceAccountToken"] is False


def test_what_is_written_to_is_a_volume() -> None:
    mounted = {mount["mountPath"]: mount["name"] for mount in CONTAINER["volumeMounts"]}
    assert set(mounted) == {"/tmp"}  # plans and jobs are in the database
    assert set(mounted.values()) == {volume["name"] for volume in POD["volumes"]}


def test_settings_are_those_of_the_service_and_no_key_is_written_here() -> None:
    known = {f"IKPLAN_{name}".upper() for name in Settings.model_fields}
    env = {entry["name"]: entry for entry in CONTAINER["env"]}
    assert set(env) <= known
    assert "secretKeyRef" in env["IKPLAN_API_KEYS"]["valueFrom"]
    assert "secretKeyRef" in env["IKPLAN_STORE_URL"]["valueFrom"]
    assert env["IKPLAN_WORKERS"]["valueFrom"]["resourceFieldRef"]["resource"] == "limits.cpu"


def test_a_pod_gets_the_time_to_stop() -> None:
    before = CONTAINER["lifecycle"]["preStop"]["sleep"]["seconds"]
    assert POD["terminationGracePeriodSeconds"] >= before + Settings().stop_s + 5


def test_the_service_of_that_name_does_not_set_the_port() -> None:
    # Kubernetes sets IKPLAN_PORT=tcp://... for a Service `ikplan`, unless it is told not to.
    assert BY_KIND["Service"]["metadata"]["name"] == "ikplan"
    assert POD["enableServiceLinks"] is False


def test_the_workers_fit_into_the_memory() -> None:
    limits = CONTAINER["resources"]["limits"]
    (own,) = [e["value"] for e in CONTAINER["env"] if e["name"] == "IKPLAN_WORKER_MEMORY_BYTES"]
    service = 2**29
    assert int(limits["cpu"]) * int(own) + service <= int(limits["memory"][:-2]) * 2**30


def test_selectors_find_the_pods() -> None:
    labels = BY_KIND["Deployment"]["spec"]["template"]["metadata"]["labels"]
    assert BY_KIND["Deployment"]["spec"]["selector"]["matchLabels"] == labels
    assert BY_KIND["Service"]["spec"]["selector"] == labels
    assert BY_KIND["PodDisruptionBudget"]["spec"]["selector"]["matchLabels"] == labels
    assert BY_KIND["NetworkPolicy"]["spec"]["podSelector"]["matchLabels"] == labels


def test_the_autoscaler_scales_the_deployment_alone() -> None:
    deployment = BY_KIND["Deployment"]
    target = BY_KIND["HorizontalPodAutoscaler"]["spec"]["scaleTargetRef"]
    assert target == {
        "apiVersion": deployment["apiVersion"],
        "kind": "Deployment",
        "name": deployment["metadata"]["name"],
    }
    assert "replicas" not in deployment["spec"]  # or each update would undo the scaling
    assert "cpu" in CONTAINER["resources"]["requests"]  # what utilization is a share of


def test_the_image_is_this_version() -> None:
    assert CONTAINER["image"] == f"ikplan:{ikplan.__version__}"


def test_any_pod_answers_any_request() -> None:
    assert "sessionAffinity" not in BY_KIND["Service"]["spec"]


def test_pods_are_as_many_as_the_queue_of_jobs_asks_for() -> None:
    from ikplan_api.app import create_app

    (metric,) = [
        entry["external"]["metric"]["name"]
        for entry in BY_KIND["HorizontalPodAutoscaler"]["spec"]["metrics"]
        if entry["type"] == "External"
    ]
    text = create_app(Settings(store_path=":memory:")).state.metrics.text().decode()
    assert f"# TYPE {metric} gauge" in text


def test_the_database_can_be_reached_and_nothing_else() -> None:
    (names, database) = BY_KIND["NetworkPolicy"]["spec"]["egress"]
    assert {port["port"] for port in names["ports"]} == {53}
    assert [port["port"] for port in database["ports"]] == [5432]
