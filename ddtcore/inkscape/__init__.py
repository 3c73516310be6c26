# SPDX-License-Identifier: GPL-2.0-or-later
"""What the extension needs and inkex does not give: from a picture in a document to a layer over it.

`settings` reads the dialog, `pictures` finds what is to be traced, `source` reads
its bytes, `decode` makes pixels of them, `placement` says where Inkscape shows
them, `layer` puts the drawing there, `links` repairs what Inkscape 1.4 breaks,
`faults` and `log` tell the user what went wrong, and `effect` runs them in this order.
"""
