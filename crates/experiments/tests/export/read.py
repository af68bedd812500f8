"""Prints what polars and DuckDB find in a folder of tables: {tool: {"rows": {table: number}, "actions": number that are not null,
"dead_units": sum of all list elements, "success": {cell: {world: mean over the seeds}}}}."""

import json
import sys
from pathlib import Path

import duckdb
import polars as pl

TABLES = ["episodes", "training", "steps"]
folder = Path(sys.argv[1])


def by_polars():
    tables = {name: pl.read_parquet(folder / f"{name}.parquet") for name in TABLES}
    seeds = tables["episodes"].group_by("cell", "world", "seed").agg((pl.col("outcome") == "success").mean().alias("success"))
    return {
        "rows": {name: table.height for name, table in tables.items()},
        "actions": tables["steps"]["action"].count(),
        "dead_units": tables["training"]["dead_units"].explode().sum(),
        "success": nested(seeds.group_by("cell", "world").agg(pl.col("success").mean()).rows()),
    }


def by_duckdb():
    def sql(query):
        for name in TABLES:
            query = query.replace(f"{{{name}}}", f"read_parquet('{folder / name}.parquet')")
        return duckdb.sql(query).fetchall()

    seeds = "select cell, world, seed, avg((outcome = 'success')::int) as success from {episodes} group by all"
    return {
        "rows": {name: sql(f"select count(*) from {{{name}}}")[0][0] for name in TABLES},
        "actions": sql("select count(action) from {steps}")[0][0],
        "dead_units": sql("select sum(share) from (select unnest(dead_units) as share from {training})")[0][0],
        "success": nested(sql(f"select cell, world, avg(success) from ({seeds}) group by all")),
    }


def nested(rows):
    cells = {}
    for cell, world, success in rows:
        cells.setdefault(cell, {})[world] = success
    return cells


json.dump({"polars": by_polars(), "duckdb": by_duckdb()}, sys.stdout)
