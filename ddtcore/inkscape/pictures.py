# SPDX-License-Identifier: GPL-2.0-or-later
"""Which pictures are to be traced: those selected, within groups and clones too, or the only one."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Dict, FrozenSet, Iterable, Iterator, List, Sequence, Tuple

import inkex

from .source import href
from .words import _, brief

Chain = Tuple[inkex.BaseElement, ...]
Elements = Dict[str, inkex.BaseElement]

CONTAINERS = ("a", "g", "svg", "switch")
DEFINITIONS = ("clipPath", "defs", "marker", "mask", "pattern", "symbol")
MOST_STEPS = 100_000
"""Steps through clones after which the search for pictures gives up: clones of clones multiply without end."""

DEEPEST = 1000
"""Length of a chain of clones at which it gives up as well."""


@dataclass(frozen=True)
class Picture:
    """A picture in one of the places where the document shows it.

    Attributes
    ----------
    chain : tuple of BaseElement
        From the child of the document's root down to the image; a clone is followed
        by what it is a clone of.
    """

    chain: Chain

    @property
    def image(self) -> inkex.Image:
        """The element that holds the bitmap."""
        return self.chain[-1]

    @property
    def shown(self) -> inkex.BaseElement:
        """The element of the document that shows the picture: the image, or a clone."""
        return next((element for element in self.chain if isinstance(element, inkex.Use)), self.image)

    @property
    def name(self) -> str:
        """What the user knows the picture as."""
        return name_of(self.shown)


def name_of(element: inkex.BaseElement) -> str:
    """Label of an element, or else its id, or else its kind.

    Parameters
    ----------
    element : BaseElement
    """
    return str(element.get("inkscape:label") or element.get("id") or element.TAG)


def find_pictures(svg: inkex.SvgDocumentElement, ids: Sequence[str]) -> List[Picture]:
    """Find the pictures to be traced, in the order in which they are drawn.

    Parameters
    ----------
    svg : SvgDocumentElement
    ids : sequence of str
        What is selected.

    Returns
    -------
    list of Picture
        At least one.

    Raises
    ------
    AbortExtension
        There is none, or, with nothing selected, more than one.
    """
    elements = _by_id(svg)
    if not ids:
        return [_only_picture(svg, elements)]
    missing = [name for name in ids if name not in elements]
    if missing:
        raise inkex.AbortExtension(
            _('There is no object with the id "{id}" in the document.').format(id=brief(missing[0])))
    chosen = [elements[name] for name in ids]
    starts = [start for element in chosen for start in _starts(element)]
    found = dict.fromkeys(_shown_in(starts, elements))
    if not found:
        raise inkex.AbortExtension(_why_none(chosen, elements))
    order = {element: number for number, element in enumerate(svg.iter())}
    return sorted(map(Picture, found), key=lambda picture: [order[element] for element in picture.chain])


def cloned_ids(svg: inkex.SvgDocumentElement) -> FrozenSet[str]:
    """The ids of elements that clones show a second time.

    Parameters
    ----------
    svg : SvgDocumentElement

    Returns
    -------
    frozenset of str
    """
    return frozenset(href(use)[1:] for use in svg.iter() if isinstance(use, inkex.Use))


def is_cloned(element: inkex.BaseElement, ids: FrozenSet[str]) -> bool:
    """Whether a clone shows an element, or what holds it, a second time.

    Parameters
    ----------
    element : BaseElement
    ids : frozenset of str
        From `cloned_ids`.
    """
    return any(one.get("id") in ids for one in (element, *element.iterancestors()) if one.get("id"))


def _by_id(svg: inkex.SvgDocumentElement) -> Elements:
    return {element.get("id"): element for element in reversed(list(svg.iter()))
            if isinstance(element, inkex.BaseElement) and element.get("id")}


def _ancestry(element: inkex.BaseElement) -> Chain:
    # Without the root, whose coordinates the result is given in.
    return tuple(reversed([element, *element.iterancestors()]))[1:]


def _starts(element: inkex.BaseElement) -> List[Chain]:
    """The way to an element, or to each of the children of the root."""
    chain = _ancestry(element)
    return [chain] if chain else [(child,) for child in element if isinstance(child, inkex.BaseElement)]


def _shown_in(starts: Iterable[Chain], elements: Elements) -> Iterator[Chain]:
    stack = [start for start in starts if not any(element.TAG in DEFINITIONS for element in start)]
    steps = 0
    while stack:
        chain = stack.pop()
        element = chain[-1]
        in_clone = any(isinstance(step, inkex.Use) for step in chain)
        steps += in_clone
        if steps > MOST_STEPS or (in_clone and len(chain) > DEEPEST):
            raise inkex.AbortExtension(_("The selection holds too many clones; select fewer objects."))
        if isinstance(element, inkex.Image):
            yield chain
        elif isinstance(element, inkex.Use):
            target = elements.get(href(element)[1:])
            if target is not None and target not in chain:
                stack.append((*chain, target))
        elif _shows_children(chain):
            stack.extend((*chain, child) for child in reversed(element)
                         if isinstance(child, inkex.BaseElement))


def _shows_children(chain: Chain) -> bool:
    cloned_symbol = chain[-1].TAG == "symbol" and len(chain) > 1 and isinstance(chain[-2], inkex.Use)
    return chain[-1].TAG in CONTAINERS or cloned_symbol


def _only_picture(svg: inkex.SvgDocumentElement, elements: Elements) -> Picture:
    found = list(map(Picture, _shown_in(_starts(svg), elements)))
    originals = [picture for picture in found if picture.shown is picture.image]
    if len(originals or found) == 1:
        return (originals or found)[0]
    if not found:
        raise inkex.AbortExtension(_("The document shows no picture that could be traced."))
    raise inkex.AbortExtension(_("Nothing is selected, and the document shows {count} pictures; select those to"
                                 " be traced.").format(count=len(found)))


def _why_none(chosen: Sequence[inkex.BaseElement], elements: Elements) -> str:
    for element in chosen:
        if any(step.TAG in DEFINITIONS for step in _ancestry(element)):
            return _('"{name}" is part of a definition and not shown itself; select a clone'
                     " of it.").format(name=brief(name_of(element)))
        if _filled_with_picture(element, elements):
            return _('"{name}" is filled with a picture as a pattern; choose Object > Pattern > Pattern to'
                     " Objects first, then select the picture.").format(name=brief(name_of(element)))
    return _('"{name}" is not a picture and holds none; select one or more pictures.').format(
        name=brief(name_of(chosen[0])))


def _filled_with_picture(element: inkex.BaseElement, elements: Elements) -> bool:
    fill = element.style.get("fill", element.get("fill")) or ""
    pattern = elements.get(fill[5:].partition(")")[0].strip("\"'")) if fill.startswith("url(#") else None
    for _step in range(len(elements)):  # patterns that refer to patterns, perhaps in a circle
        if pattern is None or pattern.TAG != "pattern":
            return False
        if any(isinstance(child, inkex.Image) for child in pattern.iter()):
            return True
        pattern = elements.get(href(pattern)[1:])
    return False
