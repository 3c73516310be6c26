# SPDX-License-Identifier: GPL-2.0-or-later
"""What the extension needs and inkex does not give: from a picture in a document to a layer over it.

`document` reads and writes the document, `settings` reads the dialog, `pictures` finds what is to
be traced, `source` reads its bytes, `decode` makes pixels of them, `placement` says where
Inkscape shows them, `layer` puts the drawing there, `links` repairs what Inkscape 1.4
breaks, `faults`, `log` and `words` tell the user what went wrong, in a language of
theirs, and `effect` runs them in this order.
"""
