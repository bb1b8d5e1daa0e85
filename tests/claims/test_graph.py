"""Verdicts as edges of the public graph of claims: a field of theirs for each of ours, and a schema that refuses what is none."""

import json

import pytest

from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.io.json_file import read_object
from barrierbench_analysis.io.spec_file import checked
from barrierbench_analysis.pages.claims import graph, verb
from barrierbench_analysis.studies.claims.entry import ids, read_claim
from barrierbench_analysis.studies.claims.judge import Answer, judge
from barrierbench_analysis.studies.claims.proofs import Eval
from barrierbench_analysis.studies.claims.table import FILE, Table, read
from barrierbench_analysis.studies.claims.verdict import Judged


def test_every_claim_is_an_edge_between_nodes_that_are_there(tmp_path):
    """The file that the verb writes; dimensions of an edge differ, so that no edge stands twice."""
    out = tmp_path / "graph.yaml"
    assert verb.main(["--export", str(out)]) == 0
    found = json.loads(out.read_text())
    nodes, edges = {node["id"] for node in found["nodes"]}, found["edges"]
    assert {edge["claim_id"] for edge in edges} == set(ids()) and nodes == {edge[end] for edge in edges for end in ("from", "to")}
    assert len({(edge["claim_id"], edge["dimension"]) for edge in edges}) == len(edges) == len(ids()) + 2
    assert all(edge["measured"] and edge["evidence"] for edge in edges) and len(nodes) == len(found["nodes"])


def test_status_evidence_and_sizes_are_those_of_the_verdict():
    """The confirmed verdict, with the number of a part in the dimension of the edge."""
    table = read(FILE)
    answers = [judge(read_claim(name), table, Eval(None, table.answers)) for name in ("K9", "K13", "K17", "H8")]
    edges = {(edge["claim_id"], edge["dimension"]): edge for edge in graph.graph(answers, table)["edges"]}
    for answer in answers:
        stated = (answer.confirmed or answer.verdict).verdict
        for edge in (edge for edge in edges.values() if edge["claim_id"] == answer.claim.id):
            assert (edge["verdict"], edge["status"]) == (stated, graph.STATUS[stated]) and edge["claim"] == answer.claim.sentence
    seconds, newton = edges["K13", "speed"], edges["K13", "convergence"]
    assert seconds["evidence"].startswith("seconds of the steps: ") and newton["evidence"].startswith("Newton iterations: ")
    assert edges["K17", "quality"]["assessed_by"] == "barrierbench (exploratory)" and "of small scenes (up to 1,536 unknowns)" in edges["K17", "quality"]["notes"]
    measured = edges["K17", "quality"]["measured"]
    assert measured["unknowns"] == [48, 864] and measured["commit"] == table.sweeps["resolution"].about["commit"] and measured["lower"] < measured["value"] < measured["upper"]
    assert edges["H8", "quality"]["measured"]["unknowns"] == [] and edges["H8", "quality"]["assessed_by"] == "barrierbench (closed form)"


def test_every_verdict_has_a_status():
    assert graph.STATUS == {"holds": "validated", "holds in part": "qualified", "holds only if": "qualified", "does not hold": "refuted", "not decided": "unvalidated"}


def test_what_was_not_run_is_claimed_by_its_authors_alone():
    (edge,) = graph.graph([Answer(read_claim("K9"), Judged("not decided", missing="waits for x"), [])], Table())["edges"]
    assert edge["status"] == "self-claimed" and edge["measured"] is None and edge["guarantee_preserved"] == "approx"


@pytest.mark.parametrize("key, value, said", [
    ("status", "proven", "found 'proven'; one of self-claimed, validated"), ("dimension", "conditioning", "found 'conditioning'; one of speed"),
    ("claim_id", "3", "the id of a claim is needed"), ("notes", None, "text is needed"), ("more", 1, "more: unknown; allowed: from, to")])
def test_the_schema_refuses_what_is_no_edge(key, value, said):
    (edge,) = graph.graph([Answer(read_claim("K9"), Judged("not decided"), [])], Table())["edges"]
    with pytest.raises(UserError, match=said):
        checked({"nodes": read_object(graph.FILE)["nodes"], "edges": [{**edge, key: value}]}, graph.FILE, graph.KIND)
