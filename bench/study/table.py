"""The raw figures: a CSV file with a row for each run, and medians over the repetitions."""
import csv
import math
import os
import statistics


def number(text):
    try:
        value = float(text)
        return int(value) if value.is_integer() and "." not in text and "e" not in text else value
    except ValueError:
        return text


def rounded(value):
    return f"{value:.6g}" if isinstance(value, float) else value


class Table:
    """`keys_of_a_run`: the columns that, in addition to the repetition, distinguish one run from the others."""

    def __init__(self, file, keys_of_a_run):
        self.file = file
        self.keys_of_a_run = keys_of_a_run
        self.rows = []
        if file.exists():
            with open(file, newline="", encoding="utf-8") as stream:
                self.rows = [{k: number(v) for k, v in row.items()} for row in csv.DictReader(stream)]
        self.keys = {self.key_of(row) for row in self.rows}

    def key_of(self, row):
        """As text, so that what was read and what is planned agree."""
        return tuple(f"{row[k]:g}" if isinstance(row[k], (int, float)) else str(row[k]) for k in [*self.keys_of_a_run, "repetition"])

    def has(self, row):
        return self.key_of(row) in self.keys

    def add(self, row):
        """Is in the file when this returns, whatever happens then."""
        self.rows.append(row)
        self.keys.add(self.key_of(row))
        self.write()

    def drop(self, study):
        self.rows = [row for row in self.rows if row["study"] != study]
        self.keys = {self.key_of(row) for row in self.rows}
        self.write()

    def write(self):
        columns = [*self.keys_of_a_run, "repetition"]
        for r in self.rows:
            columns += [k for k in r if k not in columns]
        temporary = self.file.with_suffix(".new")
        with open(temporary, "w", newline="", encoding="utf-8") as stream:
            writer = csv.DictWriter(stream, columns, restval="", lineterminator="\n")
            writer.writeheader()
            writer.writerows({k: rounded(v) for k, v in r.items()} for r in self.rows)
            stream.flush()
            os.fsync(stream.fileno())
        temporary.replace(self.file)

    def select(self, **values):
        return [r for r in self.rows if all(str(r.get(k, "")) == str(v) for k, v in values.items())]

    def values(self, column, **where):
        return sorted({r[column] for r in self.select(**where) if r.get(column, "") != ""}, key=lambda v: (isinstance(v, str), v))

    def series(self, figure, **where):
        """Of the repetitions of one configuration."""
        return [r[figure] for r in self.select(**where) if isinstance(r.get(figure), (int, float))]


def median(values):
    return statistics.median(values) if values else None


def quartiles(values):
    """Lower and upper; of fewer than four values the extremes."""
    if not values:
        return None, None
    if len(values) < 4:
        return min(values), max(values)
    q = statistics.quantiles(values, n=4, method="inclusive")
    return q[0], q[2]


def spread(values):
    """Half the distance of the quartiles, as a share of the median; infinite when there is but one value."""
    if len(values) < 2:
        return math.inf
    middle = median(values)
    low, high = quartiles(values)
    return (high - low) / 2 / middle if middle else 0
