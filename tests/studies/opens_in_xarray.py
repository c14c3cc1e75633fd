"""A study's netCDF file and its CSV hold the same table, as xarray and csv read them."""
import csv
import math
import sys
from pathlib import Path

import xarray

folder = Path(sys.argv[1])
rows = list(csv.DictReader((folder / "study.csv").open(encoding="utf-8")))
assert rows, "the table is empty"
for engine in ("netcdf4", "h5netcdf"):
    with xarray.open_dataset(folder / "study.nc", engine=engine) as table:
        assert table.sizes["point"] == len(rows), engine
        assert table["point"].dtype.kind == "i", engine
        assert [str(label) for label in table["label"].values] == [r["label"] for r in rows], engine
        for name in table.data_vars:
            if name not in rows[0] or table[name].dtype.kind != "f":
                continue
            for value, row in zip(table[name].values, rows):
                expected = float(row[name]) if row[name] else math.nan
                assert value == expected or (math.isnan(value) and math.isnan(expected)), name
