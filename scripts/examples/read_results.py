# SPDX-License-Identifier: GPL-3.0-or-later
"""Reads a result folder of dendrofit with pandas.  usage: read_results.py FOLDER   (apt-get install python3-pandas)"""
import json
import sys

import numpy as np
import pandas as pd

folder = sys.argv[1]
qsm = pd.read_csv(folder + "/qsm.csv")  # one row a cylinder, metres
metrics = json.load(open(folder + "/metrics.json", encoding="utf-8"))
qsm["volume_m3"] = np.pi * qsm.radius**2 * qsm.length
print(qsm.groupby("order")[["length", "volume_m3"]].sum().round(6))
print("cylinders", len(qsm), "volume_m3", round(qsm.volume_m3.sum(), 6), "height_m", round(metrics["height_m"], 3))
assert abs(qsm.volume_m3.sum() - metrics["total_volume_m3"]) <= 1e-6 * metrics["total_volume_m3"] + 1e-9
