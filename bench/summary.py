#!/usr/bin/env python3
"""Reduces what g3r_bench_table measured to docs/results, and writes the tables of the documentation from it. Standard library only.

    summary.py reduce TABLE.json... -o docs/results/clean.json   one line per method, input, number of points and model, with the commit;
                                                                 what the file has of the same goes, all else in it stays
    summary.py tables                                            rewrites the tables in README.md and docs
    summary.py check                                             exit code 1 where a table differs from docs/results

A table stands between two lines, <!-- results NAME --> and <!-- /results -->; TABLES below has the names. docs/results/README.md
describes the files.
"""

import argparse
import json
import pathlib
import re
import statistics
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
RESULTS = ROOT / "docs" / "results"
LISTS = ("normals", "meshes")
BLOCK = re.compile(r"(<!-- results ([\w.-]+) -->\n).*?(<!-- /results -->)", re.S)
MESH_SCORES = ("cd", "ae_m", "hd", "components", "genus", "self_intersections", "cpu_seconds")

NAMES = {  # of the methods, as the tables show them, in this order
    "default": "g3r",
    "wnnc": "WNNC, bandwidth from the spacing",
    "wnnc;widths=clean": "WNNC, its preset for clean data",
    "agr": "AGR (ours, tuned by us)",
    "paper": "as published (`--preset paper`)",
    "pgr": "PGR",
}
SHORT = {"default": "g3r", "wnnc": "wnnc", "wnnc;widths=clean": "wnnc preset", "agr": "agr", "paper": "paper", "pgr": "pgr"}
WORST = 10  # models that a table of models has: what fails is among them, and docs/results has all
POISSON = ";mesher=poisson;depth=10"


# --- files


def digits(value, count=4):
    return float(f"{value:.{count}g}") if isinstance(value, float) else value


def reduce_tables(paths, meshes_only=False):
    """The rows of tables of one commit, as docs/results holds them: that commit is the fifth of each. Rows with an error are named on
    stderr and left out."""
    labels, seeds, normals, meshes = set(), set(), [], []
    for path in paths:
        table = json.loads(pathlib.Path(path).read_text(encoding="utf-8"))
        labels.add(table["label"])
        seeds.add(table["seed"])
        for row in table["rows"]:
            name = [row.get("method"), row.get("input"), row.get("points"), row["model"]]
            if "error" in row:
                print(f"left out: {name}: {row['error']}", file=sys.stderr)
                continue
            if not meshes_only:
                normals.append(name + [table["label"], digits(row["ae_p"]), digits(row["pco"], 6), digits(row["cpu_seconds"], 3)])
            if "mesh_error" in row:
                print(f"left out: {name}: {row['mesh_error']}", file=sys.stderr)
            if "mesh" in row:
                meshes.append(name + [table["label"]] + [digits(row["mesh"].get(score)) for score in MESH_SCORES])
    if len(labels) != 1 or len(seeds) != 1:
        sys.exit(f"these tables are of different commits or seeds: {sorted(labels)}, {sorted(seeds)}")
    return {"seed": seeds.pop(), "normals": normals, "meshes": meshes}


def updated(old, new):
    """Results with the rows of `new`, and those of `old` that were not measured anew."""
    if old["seed"] != new["seed"]:
        sys.exit(f"the results are of seed {old['seed']}, these tables of {new['seed']}")
    rows = {kind: {tuple(row[:4]): row for row in old[kind] + new[kind]} for kind in LISTS}
    return {"seed": new["seed"], **{kind: list(found.values()) for kind, found in rows.items()}}


def write_results(results, path):
    def ordered(rows):  # by input, points, model and method
        return sorted(rows, key=lambda row: (row[1], row[2], row[3], row[0]))

    lists = [f' "{kind}": [\n' + ",\n".join("  " + json.dumps(row) for row in ordered(results[kind])) + "\n ]" if results[kind] else
             f' "{kind}": []' for kind in LISTS]
    pathlib.Path(path).write_text("{\n" + f' "seed": {results["seed"]},\n' + ",\n".join(lists) + "\n}\n", encoding="utf-8")


def read_results(path):
    return json.loads(pathlib.Path(path).read_text(encoding="utf-8"))


class Results:
    """All rows of docs/results by (method, input, points), with the commit each was measured on."""

    def __init__(self, folder=RESULTS):
        self.normals, self.meshes = {}, {}
        self.files = {}
        for path in sorted(pathlib.Path(folder).glob("*.json")):
            table = read_results(path)
            self.files[path.name] = table
            for rows, found in ((table["normals"], self.normals), (table["meshes"], self.meshes)):
                for method, kind, points, model, commit, *scores in rows:
                    group = found.setdefault((method, kind, points), {})
                    if model in group:
                        sys.exit(f"{path}: {method}, {kind}, {points} points of {model} is there twice")
                    group[model] = (commit, scores)

    def of(self, method, kind, points):
        return self.normals.get((method, kind, points), {})


def commits_of(groups):
    return sorted({commit for group in groups for commit, _ in group.values()})


# --- tables


def table_text(head, rows):
    lines = ["| " + " | ".join(head) + " |", "|" + "---|" * len(head)]
    return "\n".join(lines + ["| " + " | ".join(row) + " |" for row in rows]) + "\n"


def of_commit(groups):
    """The line above a table: the commit, or that it is of several."""
    commits = commits_of(groups)
    return f"Commit {', '.join(commits)}.\n\n" if commits else ""


def score_cells(group):
    errors = [100 * scores[0] for _, scores in group.values()]
    shares = {model: 100 * scores[1] for model, (_, scores) in group.items()}
    worst = min(shares, key=shares.get)
    return [f"{statistics.mean(errors):.2f}", f"{statistics.median(errors):.2f}", f"{statistics.mean(shares.values()):.2f}",
            f"{shares[worst]:.1f} ({worst})"]


def time_cell(group, base):
    """Processor time against the default's, over the models of both; only of one commit, which is of one machine."""
    if len(commits_of([group, base])) != 1:
        return "-"
    models = sorted(set(group) & set(base))
    return f"{sum(group[m][1][2] for m in models) / sum(base[m][1][2] for m in models):.1f}"


def method_table(results, points, kind="clean"):
    groups = {method: results.of(method, kind, points) for method in NAMES}
    rows = [[NAMES[method], *score_cells(group), time_cell(group, groups["default"])] for method, group in groups.items() if group]
    head = ["method", "AE_p mean", "median", "PCO mean", "lowest (model)", "time"]
    return of_commit(groups.values()) + table_text(head, rows)


def noise_table(results):
    rows, groups = [], []
    for percent in ("0.25", "0.5"):
        for method, name in (("default", "g3r"), (f"wnnc;widths=noise-{percent}", "WNNC, its preset for this noise"),
                             ("ceiling", "the best possible, knowing the surface")):
            group = results.of(method, f"noise:{percent}", 50000)
            if group:
                groups.append(group)
                rows.append([f"{percent} %", name, str(len(group)), *score_cells(group)])
    return of_commit(groups) + table_text(["noise", "method", "models", "AE_p mean", "median", "PCO mean", "lowest (model)"], rows)


def worst_models(group, score):
    """The WORST models by a score, which is larger where it is worse; of equal ones the first by name."""
    return sorted(sorted(group), key=lambda model: -score(model))[:WORST]


def model_table(results, points):
    """AE_p/PCO of every method on the models of which the default has the largest AE_p."""
    groups = [(SHORT[method], results.of(method, "clean", points)) for method in NAMES]
    columns = [(title, group) for title, group in groups if group]
    default = results.of("default", "clean", points)
    models = worst_models(default, lambda model: default[model][1][0])

    def cell(group, model):
        if model not in group:
            return "-"
        error, share = group[model][1][:2]
        return f"{100 * error:.3f}/{100 * share:.2f}"

    rows = [[model, *(cell(group, model) for _, group in columns)] for model in models]
    return of_commit([group for _, group in columns]) + table_text(["model", *(title for title, _ in columns)], rows)


def mesh_pairs(results):
    """(title, field mesher, screened Poisson) of every input that both were measured on."""
    for title, method, kind in (("true", "true", "clean"), ("g3r", "default", "clean"),
                                ("g3r, noise 0.5 %", "default", "noise:0.5")):
        field, poisson = (results.meshes.get((name, kind, 50000), {}) for name in (method, method + POISSON))
        if field and poisson:
            yield title, field, poisson


def mesh_table(results):
    rows, groups = [], []
    for title, field, poisson in mesh_pairs(results):
        models = sorted(set(field) & set(poisson))
        groups += [field, poisson]
        for index, score, unit in ((0, "CD, 1e-3", 1e3), (1, "AE_m, 1e-2", 100), (2, "HD, 1e-2", 100)):
            ours, theirs = ([unit * group[m][1][index] for m in models] for group in (field, poisson))
            worst = max(models, key=lambda m: field[m][1][index] / poisson[m][1][index])
            rows.append([title, score, f"{statistics.mean(ours):.3f} / {statistics.mean(theirs):.3f}",
                         f"{statistics.mean(ours) / statistics.mean(theirs):.2f}",
                         f"{statistics.median(ours):.3f} / {statistics.median(theirs):.3f}",
                         f"{field[worst][1][index] / poisson[worst][1][index]:.2f} ({worst})"])
    head = ["normals", "score", "mean", "ratio", "median", "worst ratio (model)"]
    return of_commit(groups) + table_text(head, rows)


def mesh_models(results):
    """Of the models of which the field mesher has the largest AE_m."""
    title, field, poisson = next(pair for pair in mesh_pairs(results) if pair[0] == "g3r")
    rows = []
    for model in worst_models(set(field) & set(poisson), lambda model: field[model][1][1]):
        ours, theirs = field[model][1], poisson[model][1]
        pairs = [f"{unit * ours[i]:.3f}/{unit * theirs[i]:.3f}" for i, unit in ((0, 1e3), (1, 100), (2, 100))]
        counts = ["/".join("?" if group[i] is None else str(int(group[i])) for group in (ours, theirs)) for i in (3, 4, 5)]
        rows.append([model, *pairs, *counts])
    head = ["model", "CD, 1e-3", "AE_m, 1e-2", "HD, 1e-2", "components", "genus", "crossing pairs"]
    return of_commit([field, poisson]) + table_text(head, rows)


TABLES = {
    "clean-50k": lambda results: method_table(results, 50000),
    "clean-5k": lambda results: method_table(results, 5000),
    "noise-50k": noise_table,
    "models-50k": lambda results: model_table(results, 50000),
    "meshes-50k": mesh_table,
    "mesh-models": mesh_models,
}


def with_tables(text, results):
    def block(match):
        return f"{match.group(1)}\n{TABLES[match.group(2)](results)}\n{match.group(3)}"

    return BLOCK.sub(block, text)


def pages():
    return [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md"))]


def stale_pages(results):
    """The pages whose tables are not those of docs/results, with their text as it should be."""
    texts = ((page, page.read_text(encoding="utf-8")) for page in pages())
    return {page: new for page, text in texts if (new := with_tables(text, results)) != text}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    commands = parser.add_subparsers(dest="command", required=True)
    reduce = commands.add_parser("reduce")
    reduce.add_argument("tables", nargs="+")
    reduce.add_argument("-o", "--output", required=True)
    reduce.add_argument("--meshes-only", action="store_true", help="leave out the normals, which another table has")
    commands.add_parser("tables")
    commands.add_parser("check")
    arguments = parser.parse_args()
    if arguments.command == "reduce":
        results = reduce_tables(arguments.tables, arguments.meshes_only)
        if pathlib.Path(arguments.output).exists():
            results = updated(read_results(arguments.output), results)
        write_results(results, arguments.output)
        return
    stale = stale_pages(Results())
    for page, text in stale.items():
        if arguments.command == "tables":
            page.write_text(text, encoding="utf-8")
        print(page.relative_to(ROOT), "rewritten" if arguments.command == "tables" else "differs from docs/results")
    sys.exit(1 if stale and arguments.command == "check" else 0)


if __name__ == "__main__":
    main()
