#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-2.0-or-later
"""DDT Trace: turn the selected pictures into Bézier areas, the larger ones at the back."""

from __future__ import annotations

import os
import sys
import warnings

from ddtcore.inkscape.log import note
from ddtcore.inkscape.words import _

try:
    import inkex

    # Importing inkex turns all warnings on, and Inkscape shows each one in a box.
    warnings.simplefilter("ignore")
    from ddtcore.inkscape import document, effect, faults, links, settings, source
except ImportError as error:
    if __name__ != "__main__":
        raise
    MESSAGE = _("DDT Trace cannot start: the Python that Inkscape uses ({python}) cannot import {name}; on Debian"
                " and Ubuntu install python3-numpy, python3-pil, python3-lxml, python3-cssselect and"
                " python3-tinycss2.").format(python=sys.executable, name=error.name or error)
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
        # argparse would explain all of its arguments as well, and Inkscape show that in a box.
        self.arg_parser.error = self.refuse_settings
        super().parse_arguments(args)
        try:
            settings.trace_options(self.options)
        except (TypeError, ValueError) as error:
            self.refuse_settings(error)

    def refuse_settings(self, reason):
        text = _("A setting is wrong: {reason}.").format(reason=reason)
        self.arg_parser.exit(2, "" if note(text) else text + "\n")

    def load(self, stream):
        with faults.plain_messages():
            tree = document.load_document(stream, str(self.options.input_file))
        self.svg = tree.getroot()
        self.svg.selection.set(*self.options.ids)
        return tree

    def save_raw(self, ret):
        with faults.plain_messages():
            document.save_document(self.document, self.options.output)

    def effect(self):
        copy = self.options.input_file if isinstance(self.options.input_file, str) else None
        folders = source.link_folders(self.inkscape_document, copy)
        with faults.plain_messages():
            effect.trace_pictures(self.svg, self.options, folders)
            if self.inkscape_document is not None:
                links.make_links_absolute(self.svg, folders)


if __name__ == "__main__":
    DdtTrace().run()
