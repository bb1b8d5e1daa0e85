"""The rows of the verbs in Python: one line each, beside the file that it names."""

from __future__ import annotations

from typing import NamedTuple

ENVIRONMENT = "environment"  # the Python environment, which ./bench has made
PROGRAM = "program"  # the release build of barrierbench too
HELP = ("-h", "--help")
WITHOUT = (*HELP, "--no-run", "--list")  # with one of these no verb needs a built program


class Verb(NamedTuple):
    """One row of the table."""

    name: str
    group: str  # one of GROUPS
    needs: str  # ENVIRONMENT, PROGRAM, or a target of the release build
    module: str  # below barrierbench_analysis; empty: a verb of the program, or of the script ./bench itself
    arguments: str
    help: str
    example: str
    without: tuple[str, ...] = ()  # more options with which it needs no built program
    own_help: bool = True  # answers --help itself; else its row does


# fmt: off
TABLE = (
    Verb("demo", "run", PROGRAM, "front.demo", "", "setup, build, the demonstration sweep, its figures and the page that says what they show; ends with a table of what each formulation takes", "./bench demo"),
    Verb("status", "run", ENVIRONMENT, "tables.sweeps.status", "DIR [--watch]", "where the runs of a sweep are: over, running, dead, stopped, unreadable or waiting; 0 when all are over", "./bench status results/runs/demo/demo_strip --watch"),
    Verb("collect", "look", ENVIRONMENT, "tables.sweeps.collect", "DIR OUT.csv", "the records of a sweep as one tidy table, CSV and Parquet, units in its column names, and a dictionary of its columns", "./bench collect results/runs/demo/demo_strip strip.csv"),
    Verb("figures", "look", ENVIRONMENT, "figures.plots.verb", "RUNS [OUT]", "figures and table of the records below a folder, or of the file of ./bench steps --out", "./bench figures results/runs/demo"),
    Verb("report", "look", ENVIRONMENT, "pages.report.verb", "DIR [DIR2]", "one HTML page, which needs no network, of the records below a folder: answer, verdict, players, failures, comparison, figures, every run with its command, methods; of two folders what differs", "./bench report results/runs/demo"),
    Verb("formula", "look", ENVIRONMENT, "program.formula.verb", "TEXT", "a barrier as a formula: whether it is one and where it fails, its derivatives, limits, precision, C++", "./bench formula '-(d - d_hat)^2*log(d/d_hat)'"),
    Verb("render", "look", ENVIRONMENT, "figures.pictures.render", "RUN", "a still (PNG) of one step of a run that kept frames (--set /output/frames_every=1)", "./bench render results/runs/drape --color gap"),
    Verb("stills", "look", ENVIRONMENT, "figures.pictures.stills", "RUN... --out FILE.png", "the last frames of several runs in one picture, each under its label and outcome", "./bench stills results/runs/baseline_stills/* --columns 9 --out docs/baselines.png"),
    Verb("play", "look", ENVIRONMENT, "pages.play.verb", "RUN [RUN2]", "one HTML file, which needs no network, that plays a run that kept frames (--set /output/frames_every=1), or two side by side", "./bench play results/runs/drape-log results/runs/drape-cubic --color gap"),
    Verb("scenes", "look", PROGRAM, "studies.catalogue.scenes", "[NAME...]", "the scenes of the catalogue (configs/catalogue): what each stresses, its size as mini and as in its source; --write makes its config", "./bench scenes twist --write twist.json", without=("--write", "--list")),
    Verb("film", "look", ENVIRONMENT, "figures.frames_out.film", "SOURCE OUT", "frames of any program (a folder, PVD, PC2, MDD, NPZ), or of a run, as the numbered files that a config's `film` or `rest_film` names", "./bench film dance.pc2 out/dance --frame-s 0.041666667"),
    Verb("frames", "look", ENVIRONMENT, "figures.frames_out.verb", "RUN OUT --format obj|ply|pc2|vtu", "the frames of a run (--set /output/frames_every=1) as files for other tools; a finer mesh that follows a body (--render-mesh, --subdivide)", "./bench frames results/runs/drape out/drape --format vtu"),
    Verb("surface-gaps", "look", ENVIRONMENT, "tables.surface_gaps", "RUNS...", "how close the whole surface came to obstacles and to itself in each run; 1 when an ok run entered something", "./bench surface-gaps results/runs/demo results/runs/claims"),
    Verb("causes", "study", PROGRAM, "tables.causes", "RUN|CONFIG", "a condition number taken apart: stages, scalings, and where the eigenvectors of both ends live", "./bench causes configs/scenes/sphere_on_sheet.json --set /time/steps=5"),
    Verb("match", "study", PROGRAM, "studies.matching.match", "CONFIG", "calibrates formulations on one scene, runs each, says which may be compared: 0 all, 1 not all, 2 bad input", "./bench match configs/scenes/drape2d.json --formulations cubic quadratic"),
    Verb("pareto", "study", PROGRAM, "studies.matching.pareto", "[SPEC]", "formulations over decades of stiffness, compared at equal reached gap: results/PARETO.md and docs/pareto_*.png", "./bench pareto configs/pareto/default.json"),
    Verb("gap-map", "study", PROGRAM, "studies.gap_map.entry", "[SPEC]", "condition numbers and iterations against the gap that contact reaches, beside the area law: results/GAP_MAP.md and docs/gap_map.png", "./bench gap-map --quick"),
    Verb("work-precision", "study", PROGRAM, "studies.work_precision.verb", "[SPEC]", "error against work of every formulation: results/WORK_PRECISION.md and docs/work_precision_*.png", "./bench work-precision configs/work_precision/default.json"),
    Verb("ablation", "study", PROGRAM, "studies.ablation.verb", "[SPEC]", "a balanced fraction of a factorial over all choices, run in shards: main effects and interactions, results/ABLATION.md and docs/ablation.png", "./bench ablation --shards 1", without=("--gather",)),
    Verb("score", "judge", PROGRAM, "studies.score.verb", "FORMULA|PLUGIN|NAME", "one page for a new barrier: matched, started from jittered states and put through hard cases beside log, quadratic, cubic and a consistent stiffness (minutes)", "./bench score '(d_hat - d)^3/d'"),
    Verb("gate", "judge", PROGRAM, "studies.gate.gate", "[--set SET]", "runs a small set of cases and judges them against results/baselines; or another solver's matrices", "./bench gate --matrix dumps/*.mtx --baseline conditioning.json", without=("--matrix", "--record")),
    Verb("judge", "judge", PROGRAM, "studies.judge.verb", "TRAJECTORY", "the frames of any program before our exact audit: crossings, passages, depths, gaps, stretch, volumes: judgement.json and .html; 0 clean, 1 not", "./bench judge out/frames --about scene.json"),
    Verb("engine", "judge", PROGRAM, "studies.engines.verb", "list | NAME setup | NAME run SCENE --out DIR | compare [SPEC]", "scenes under engines of others (engines/NAME), each judged as ./bench judge does, beside ours: results/ENGINES.md, docs/engines.png", "./bench engine list", without=("list", "setup")),
    Verb("archive", "look", ENVIRONMENT, "studies.archives.archive_verb", "FOLDER FILE.zip", "a study as one file: its records and all that lies beside them, with a hash of each; compare, report, figures, collect and verify read it in the place of the folder", "./bench archive results/runs/demo/demo_strip strip.zip"),
    Verb("verify", "judge", ENVIRONMENT, "studies.archives.verify", "STUDY [--rerun N]", "records held against their files: what is missing, extra or edited; makes N runs again and asks for the same bits; 0 nothing wrong, 1 something, or nothing judged", "./bench verify results/runs/demo/demo_strip --rerun 2"),
    Verb("compare", "judge", ENVIRONMENT, "studies.gate.compare", "A B", "two records, or folders of them: which numbers differ, in which direction, 0 same, 1 regressed, 2 cannot compare", "./bench compare results/runs/before results/runs/after"),
    Verb("calibrate", "judge", PROGRAM, "studies.gate.calibrate", "", "measures envelopes for the gate by 20 perturbed copies a case", "./bench calibrate", without=("--matrix", "--record")),
    Verb("accept", "judge", ENVIRONMENT, "studies.gate.accept", "--reason TEXT", "keeps the envelopes that were measured last as baselines, with a reason", './bench accept --reason "the contact Hessian is exact"'),
    Verb("trend", "judge", ENVIRONMENT, "studies.gate.trend", "FILE", "steps in the numbers that ./bench gate --history FILE has kept, run after run; never a failure", "./bench trend history.jsonl"),
    Verb("claims", "judge", PROGRAM, "pages.claims.verb", "[ID...]", "runs what is missing, computes the verdict on every claim from its records: results/CLAIMS.md, docs/claims.png, docs/results/claims.md", "./bench claims K3 H1"),
    Verb("stress", "judge", PROGRAM, "studies.stress.verb", "[ID...]", "the hard cases of configs/stress over all formulations, against what was expected of each: results/STRESS.md", "./bench stress S09 M10"),
    Verb("catalogue", "judge", PROGRAM, "studies.catalogue.page", "[NAME...]", "the mini scenes of the catalogue under five formulations, against what each expects: results/CATALOGUE.md, docs/catalogue.png", "./bench catalogue drape --formulations log"),
    Verb("robust", "judge", PROGRAM, "studies.catalogue.robust", "SCENE...", "scenes of the catalogue from jittered starts: passes where every seed ends ok without a crossing", "./bench robust drape --seeds 10"),
    Verb("readme", "make", PROGRAM, "pages.readme.verb", "--check | --write | --fill | --reference", "runs or parses every snippet of README.md and docs; fills the numbers of README.md and docs/results from the records of the demo, or from those that are kept; writes docs/reference from what the program prints", "./bench readme --check"),
    Verb("figure", "make", PROGRAM, "studies.comparison.rebuild", "NAME... [--quick]", "a figure of the comparison, rebuilt byte for byte from its spec configs/figures/NAME.json: PNG, PDF, SVG, numbers, caption", "./bench figure work_precision --quick"),
    Verb("pictures", "make", PROGRAM, "figures.pictures.pictures", "", "the stills at the top of README, docs/picture_*.png, from runs of seconds", "./bench pictures"),
    Verb("matrix-corpus", "make", PROGRAM, "studies.matrices.matrix_corpus", "[--table]", "the hard systems of results/matrices from configs/matrices/corpus.json, and their table", "./bench matrix-corpus --table"),
    Verb("step-corpus", "make", PROGRAM, "studies.steps.step_corpus", "[--make | --take | --table]", "the hard time steps of results/steps from configs/steps/corpus.json, each by every step solver and Hessian: results/STEPS.md, docs/steps.png", "./bench step-corpus --table"),
    Verb("condition-table", "make", PROGRAM, "studies.matrices.condition_table", "", "results/CONDITION.md: what Spectra and our Lanczos take for the condition numbers of the demo and of results/matrices, and how far they differ", "./bench condition-table"),
    Verb("gpu-report", "make", ENVIRONMENT, "studies.device.gpu_report", "", "results/GPU.md and its figure from the records of cards that experiments/gpu_evidence.sh made", "./bench gpu-report"),
    Verb("mesh", "make", PROGRAM, "program.mesh_file", "IN OUT.ply", "a mesh of Gmsh (MSH 2.2, 4.1), VTK (VTU, VTP, legacy) or another program, tetrahedra too, as PLY; tetrahedra within a closed surface", "./bench mesh gear.msh gear.ply"),
    Verb("completion", "look", ENVIRONMENT, "front.completion", "bash|zsh", "a script for the shell that completes verbs, options and files", 'eval "$(./bench completion bash)"'),
    Verb("setup", "develop", ENVIRONMENT, "", "", "packages, compiler cache, Python environment; instant when all is there", "./bench setup", own_help=False),
    Verb("build", "develop", ENVIRONMENT, "front.build", "[PRESET]", "configures and builds (release by default; dev, sanitize, cuda-compile)", "./bench build sanitize", own_help=False),
    Verb("test", "develop", ENVIRONMENT, "front.test", "[--sanitize] [--browser] [CTEST ARGUMENTS]", "setup, build, format check, C++ tests, Python tests, the gate; --browser installs chromium first, so that the player is tested in it", "./bench test -L eval", own_help=False),
    Verb("format", "develop", ENVIRONMENT, "front.format", "", "clang-format every C++ file and ruff every Python file of analysis/ and python/, in place", "./bench format", own_help=False),
    Verb("tidy", "develop", ENVIRONMENT, "front.tidy", "[FILES]", "clang-tidy the sources (all, or the files named)", "./bench tidy core/base/record/hash.cpp", own_help=False),
    Verb("rooms", "develop", ENVIRONMENT, "front.rooms", "", "the rooms of the code, what each one includes, lowest first; fails on a circle or an undeclared one", "./bench rooms", own_help=False),
    Verb("python", "develop", ENVIRONMENT, "front.python_module", "[--no-tests] [PYTEST ARGUMENTS]", "builds the Python module barrierbench beside the program and runs its tests (docs/guides/python.md); pip install . builds it by itself", "./bench python --no-tests", own_help=False),
    Verb("site", "develop", ENVIRONMENT, "front.site", "", "the web site of README.md, docs and results with search and formulas, in build/site; a broken link fails", "./bench site"),
    Verb("mutate", "develop", ENVIRONMENT, "front.mutate", "", "puts mistakes into the code one at a time and counts those that the tests catch", "./bench mutate --only 'newton/armijo*'"),
    Verb("fuzz", "develop", ENVIRONMENT, "front.fuzz", "[TARGET...]", "feeds broken input to every reader under clang's sanitizers; 1 when one of them fails", "./bench fuzz mesh_ply config --seconds 60"),
    Verb("microbenchmarks", "develop", "barrierbench_microbenchmarks", "front.microbenchmarks", "[GOOGLE BENCHMARK ARGUMENTS]", "ns per shape, query, contact, element, tier; JSON kept in results/runs/microbenchmarks", "./bench microbenchmarks --benchmark_filter='drape/.*:48'", own_help=False),
    Verb("compare-toolkit", "develop", "contact_stages", "studies.toolkit.compare_toolkit", "", "our stages of contact beside those of the IPC Toolkit, in turn: a table of ratios", "./bench compare-toolkit --mesh sheets --rounds 3"),
)
# fmt: on
