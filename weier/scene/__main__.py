"""Write the JSON schema of scene files and the table of their keys into `config/`: `python -m weier.scene`."""

from pathlib import Path

from weier.scene.keys import write

write(Path("config"))
