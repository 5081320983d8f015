# %% [markdown]
# # From raw files to a certificate
# A folder of records and telemetry becomes a calibrated unit, a certificate, and compensated readings. The paths are from the
# root of the repository.

# %%
from pathlib import Path

import centrical as ct
import numpy as np

example = Path("examples/ta-200")
out = Path("certificates")
out.mkdir(exist_ok=True)

# %% [markdown]
# ## What the files show
# The draft of `experiment.toml` has what the files show; `fill_in` lists the lines that only a person knows.

# %%
draft = ct.init([example / "records", example / "telemetry"])
for line in draft.fill_in:
    print(f"line {line.line}: {line.key}: {line.reason}")

# %% [markdown]
# ## What the experiment determines
# Of the finished session; the same works with a plan, before anything is measured.

# %%
session = ct.Session(example)
seen = session.observe()
print(f"rank {seen.rank} of {seen['columns']} unknowns, {len(seen.lost)} combinations lost")

# %% [markdown]
# ## The calibration
# In a notebook the last line of a cell shows the table and the figures of the report.

# %%
result = session.calibrate()
print(result)
result

# %%
g = result["G1_11"]
print(f"{g.name} = {g.value:.5g} +- {g.u:.2g} {g.unit}")
for effect in result.rests_on[:3]:
    print(f"below {effect.smallest_shown:.2g} {effect.unit} this would not show: {effect.name}")

# %% [markdown]
# ## Readings to specific force
# An array of shape (n, 3) [m/s^2]; the uncertainties are those of the coefficients, at each force.

# %%
readings = np.array([[9.8, 0.1, 0.2], [120.0, -40.0, 3.0]])
forces, uncertainties = result.compensate(readings, uncertainty=True)
print(forces)
print(uncertainties)

# %% [markdown]
# ## Two calibrations of one unit
# Four plateaus are held out of the second one here; usually a year lies between them.

# %%
held_out = [f"{mounting}:{plateau}" for mounting in (1, 5) for plateau in (1, 2)]
print("they agree:", ct.compare([result, session.calibrate(hold_out=held_out)], years=1.0).agree)

# %% [markdown]
# ## The documents

# %%
result.to_json(out / "result.json")
written = result.report(
    html=out / "report.html",
    pdf=out / "certificate.pdf",
    dcc=out / "certificate.xml",
    code=out / "compensation",
    laboratory=example / "laboratory.toml",
)
for document in written.written:
    print(document.kind, document.path)
