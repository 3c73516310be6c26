#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-2.0-or-later
"""DDT Trace: turn the selected pictures into Bézier areas, the larger ones at the back."""

from __future__ import annotations

import os
import sys
import warnings

from ddtcore.inkscape.log import note

try:
    import inkex

    # Importing inkex turns all warnings on, and Inkscape shows each one in a box.
    warnings.simplefilter("ignore")
    from ddtcore.inkscape import document, effect, faults, links, settings, source
except ImportError as error:
    if __name__ != "__main__":
        raise
    MESSAGE = (f"DDT Trace cannot start: the Python that Inkscape uses ({sys.executable}) cannot import"
               f" {error.name or error}; on Debian and Ubuntu install python3-numpy, python3-pil,"
               " python3-lxml, python3-cssselect and python3-tinycss2.")
    sys.exit(1 if note(MESSAGE) else MESSAGE)


class DdtTrace(inkex.EffectExtension):
    """Turn the selected pictures into Bézier areas, the larger ones at the back."""

    def __init__(self) -> None:
        super().__init__()
        # Set by Inkscape, and by inkex itself later on; empty for an unsaved document.
        self.inkscape_document = os.environ.get("DOCUMENT_PATH")

    def add_arguments(self, pars):
        settings.add_arguments(pars)

    def parse_arguments(self, args):
        super().parse_arguments(args)
        try:
            settings.trace_options(self.options)
        except (TypeError, ValueError) as error:
            self.arg_parser.error(str(error))

    def load(self, stream):
        with faults.plain_messages():
            tree = document.load_document(stream, str(self.options.input_file))
        self.svg = tree.getroot()
        self.svg.selection.set(*self.options.ids)
        return tree

    def has_changed(self, ret):
        return True

    def effect(self):
        copy = self.options.input_file if isinstance(self.options.input_file, str) else None
        folders = source.link_folders(self.inkscape_document, copy)
        with faults.plain_messages():
            effect.trace_pictures(self.svg, self.options, folders)
            if self.inkscape_document is not None:
                links.make_links_absolute(self.svg, folders)


if __name__ == "__main__":
    DdtTrace().run()
