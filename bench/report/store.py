"""What was measured: a JSON file for each feature, so that a run that was interrupted goes on."""
import json
import os


class Store:
    """`size`: the name of the size of the clouds. Figures of another size are not used by a run that measures, and stay until they are measured again."""

    def __init__(self, folder, size):
        self.folder, self.size = folder, size
        self.folder.mkdir(parents=True, exist_ok=True)

    def file(self, name):
        return self.folder / f"{name}.json"

    def get(self, name):
        """The figures of a feature, of whatever size; None where it was never measured."""
        return json.loads(self.file(name).read_text(encoding="utf-8")) if self.file(name).exists() else None

    def has(self, name):
        found = self.get(name)
        return found is not None and found["size"] == self.size

    def put(self, name, figures):
        """Is on the disk as a whole when this returns."""
        part = self.file(name).with_suffix(".part")
        with open(part, "w", encoding="utf-8") as stream:
            json.dump({"size": self.size, **figures}, stream, indent=1)
            stream.write("\n")
            stream.flush()
            os.fsync(stream.fileno())
        part.replace(self.file(name))

    def drop(self, names):
        for name in names:
            self.file(name).unlink(missing_ok=True)
