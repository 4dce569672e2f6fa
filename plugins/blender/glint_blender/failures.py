# SPDX-License-Identifier: BSD-3-Clause
"""How the add-on says that something cannot be done. Operators report the text in one line."""


class InputError(Exception):
    """A file, an object or a request is wrong. `place` is the key or the object, "" where the whole is meant."""

    def __init__(self, file, place, reason):
        self.file, self.place, self.reason = str(file), str(place), str(reason)
        super().__init__(": ".join(part for part in (self.file, self.place, self.reason) if part))
