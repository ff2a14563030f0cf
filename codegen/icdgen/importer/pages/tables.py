"""Assembly of tables over any number of pages, from their pieces and captions.

Items of `flow` in reading order go in. Headings, text and complete tables come out, as
blocks of a document.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from itertools import pairwise

from icdgen.importer import labels
from icdgen.importer.document import Block
from icdgen.importer.pages import bands, captions, columns, headings
from icdgen.importer.pages.bands import Band
from icdgen.importer.pages.draft import HeadingRow, PrintedRow, TableDraft
from icdgen.importer.pages.flow import Item, TablePiece, TextItem
from icdgen.importer.pages.lines import TextLine, lines, words_of
from icdgen.importer.pages.rules import row_marks
from icdgen.importer.profile import Profile
from icdgen.importer.words import CONTINUED, squeezed


@dataclass
class TableBuilder:
    """Assembles items to drafts, in one pass."""

    profile: Profile
    document_words: frozenset[str]
    is_part: bool = False  # whether only some pages of the document are read
    out: list[TableDraft | TextItem] = field(default_factory=list)
    # Drafts are compared by their content and therefore have no hash.
    # Id of a draft -> its pieces without vertical rules.
    loose_pieces: dict[int, list[TablePiece]] = field(default_factory=dict)

    def build_tables(self, items: list[Item]) -> list[Block]:
        """Return headings, text and tables with their captions."""
        for item in items:
            if isinstance(item, TablePiece):
                self.add_piece(item)
            else:
                self.out.append(item)
        # Columns are found from all pieces of a table, which are known only now.
        for draft in self.out:
            if isinstance(draft, TableDraft) and id(draft) in self.loose_pieces:
                self.add_rows_of_loose_pieces(draft, self.loose_pieces[id(draft)])
        return captions.blocks_with_captions(self.out, self.profile, self.is_part)

    def add_piece(self, piece: TablePiece) -> None:
        """Add a piece to the draft that it continues, or begin a new draft."""
        draft = self.continued_draft(piece)
        if draft is None:
            draft = self.begin_draft(piece)
        else:
            draft.boxes.append(piece.box)
        if piece.ruled:
            self.add_ruled_piece(draft, piece)
        else:
            self.add_loose_piece(draft, piece)

    def begin_draft(self, piece: TablePiece) -> TableDraft:
        draft = TableDraft([piece.box])
        self.out.append(draft)
        return draft

    def continued_draft(self, piece: TablePiece) -> TableDraft | None:
        """Return the draft that this piece continues, or None."""
        between = 0
        number = None
        torn: list[TextItem] = []
        last: TextItem | None = None  # last line of text in between
        for item in reversed(self.out):
            if isinstance(item, TableDraft):
                break
            match = (
                self.profile.caption.match(item.text)
                if item.kind == "caption"
                else None
            )
            if match and (
                CONTINUED.search(item.text) or self.is_repeated_caption(item)
            ):
                number = match["number"]
                continue
            if item.kind == "text" and labels.leading_meaning(item.text, self.profile):
                torn.insert(0, item)  # a row above the headings, after a page break
                continue
            if item.kind != "text" or item.size > 8.6:
                return None
            between += 1
            last = item
        else:
            return None
        draft = item
        follows = piece.box.page == draft.last_page + 1
        below = (
            piece.box.page == draft.last_page
            and 0 <= piece.box.top - draft.boxes[-1].bottom < 30
        )
        if between > 3 or not (follows or below):
            return None
        if self.begins_message_table(piece):
            return None
        # A repeated caption is sufficient. Otherwise, the columns must match.
        if number is None and not self.has_columns_of(draft, piece, follows):
            return None
        if (
            number is None
            and between == 1
            and last is not None
            and self.is_group(draft, last)
        ):
            assert draft.header is not None
            draft.rows.append(
                bands.group_row(last.text, len(draft.header.roles), last.box.page)
            )
            self.out.remove(last)
        if torn and (draft.header is not None or not draft.head):
            return None
        for mark in torn:
            draft.head.append(PrintedRow([mark.text], page=mark.box.page))
            self.out.remove(mark)
        if number is not None:  # a repeated caption
            # Text between the parts stands around the page break, not in the table.
            while self.out[-1] is not draft:
                self.out.pop()
        return draft

    def is_group(self, draft: TableDraft, mark: TextItem) -> bool:
        """Return whether a line below a list is the heading of the next page's first
        group.
        """
        if draft.header is None or draft.header.kind != "list":
            return False
        box = draft.boxes[-1]
        touches = (
            mark.box.page == box.page
            and mark.box.top - box.bottom < mark.size
            and mark.box.x0 - box.x0 < 8
        )
        return mark.strong or (touches and len(mark.cells) == 1)

    def is_repeated_caption(self, mark: TextItem) -> bool:
        """Return whether an earlier caption has the same number and title."""
        return any(
            other is not mark and isinstance(other, TextItem) and other.kind == "caption"
            and squeezed(other.text) == squeezed(mark.text)
            for other in self.out
        )  # fmt: skip

    def begins_message_table(self, piece: TablePiece) -> bool:
        """Return whether the piece begins the table of a message, with its id."""
        if not piece.ruled:
            return bool(piece.head) and labels.begins_message_table(
                piece.head[0], self.profile
            )
        first = next((band for band in piece.bands if band.words), None)
        if first is None:
            return False
        texts = (
            " ".join(t for t in first.texts(self.document_words) if t),
            lines(first.words)[0].text,
        )
        return any(labels.begins_message_table(text, self.profile) for text in texts)

    def has_columns_of(
        self, draft: TableDraft, piece: TablePiece, follows: bool
    ) -> bool:
        """Return whether the columns of the piece match the draft."""
        header = draft.header
        if not piece.ruled:
            if piece.columns is None:
                return True
            return (header is None and bool(draft.head)) or (
                header is not None
                and follows
                and headings.repeats_headings(
                    piece.columns.header.titles, header, self.profile
                )
            )
        own = self.heading_row_of(piece)
        if own is not None:
            if header is None:
                return own.kind == "fields" and bool(draft.head)
            return follows and own.kind == header.kind and own.roles == header.roles
        last, box = draft.boxes[-1], piece.box
        if header is None:
            return follows and abs(box.x0 - last.x0) < 8 and abs(box.x1 - last.x1) < 8
        return abs(box.width - last.width) < 8

    def heading_row_of(self, piece: TablePiece) -> HeadingRow | None:
        """Return the heading row at the top of a piece, or None."""
        for band in piece.bands[:3]:
            header = headings.match_headings(
                band.texts(self.document_words), self.profile, loose=True
            )
            if header:
                return header
        # No rule separates headings and rows.
        split = self.split_at_headings(piece.bands[0]) if piece.bands else None
        return split[1] if split else None

    # Tables with vertical rules.

    def add_ruled_piece(self, draft: TableDraft, piece: TablePiece) -> None:
        """Add the bands of a piece with vertical rules.

        They are rows above the headings, headings or rows of the draft. If a band
        begins the table of another message, the remaining ones become a new draft.
        """
        waiting = list(piece.bands)
        is_first_row = True
        while waiting:
            band = waiting.pop(0)
            if not band.words:
                continue
            texts = band.texts(self.document_words)
            if self.is_new(draft, texts):
                draft = self.begin_draft(piece)
            if draft.header is None:
                if not self.set_heading_row(draft, band, waiting):
                    draft.head += self.rows_above_headings(band)
            elif not draft.rows and (both_lines := self.lower_half(draft, texts)):
                upper = draft.header.printed[-1:]
                for row in upper:
                    row.texts = [
                        f"{a}\n{b}".strip("\n")
                        for a, b in zip(row.texts, texts, strict=True)
                    ]
                both_lines.printed = upper
                draft.header = both_lines
            elif headings.repeats_headings(texts, draft.header, self.profile):
                # The columns can be elsewhere on this page, whose margins may differ.
                if len(band.edges) == len(draft.edges or ()):
                    draft.edges = band.edges
            elif (
                is_first_row
                and len(draft.boxes) > 1
                and (remainder := self.below_headings(draft, band)) is not None
            ):
                if remainder.words:
                    waiting.insert(0, remainder)
            else:
                self.add_rows(draft, band, torn=is_first_row and len(draft.boxes) > 1)
                is_first_row = False

    def below_headings(self, draft: TableDraft, band: Band) -> Band | None:
        """Return the remainder of a band that begins with the repeated headings, or
        None.
        """
        header = draft.header
        assert header is not None
        titles = [squeezed(title) for title in header.titles]
        lines_of_band = lines(band.words)
        for count in range(1, min(5, len(lines_of_band) + 1)):
            if [
                squeezed(text)
                for text in band.of(lines_of_band[:count]).texts(self.document_words)
            ] == titles:
                return band.of(lines_of_band[count:])
        return None

    def lower_half(self, draft: TableDraft, texts: list[str]) -> HeadingRow | None:
        """Return the complete headings if a page break separates their two lines,
        otherwise None.
        """
        header = draft.header
        assert header is not None
        if len(texts) != len(header.titles):
            return None
        both_lines = headings.match_headings(
            [f"{a} {b}".strip() for a, b in zip(header.titles, texts, strict=True)],
            self.profile,
        )
        return both_lines if both_lines and both_lines.known > header.known else None

    def is_new(self, draft: TableDraft, texts: list[str]) -> bool:
        """Return whether a band is the first of another message within the same rules."""
        has_more = draft.header is not None or len(draft.head) > 0
        return has_more and labels.begins_message_table(
            " ".join(t for t in texts if t), self.profile
        )

    def set_heading_row(
        self, draft: TableDraft, band: Band, waiting: list[Band]
    ) -> bool:
        """Set the heading row if the band contains it or its upper half.

        Return whether it does.
        """
        match = headings.match_headings(band.texts(self.document_words), self.profile)
        if match is None and not waiting:
            match = headings.match_headings(
                band.texts(self.document_words), self.profile, loose=True
            )
        printed = [band.printed(self.document_words)]
        if match is None and waiting and len(lines(band.words)) < 4:
            stacked = _stacked(band, waiting[0], self.document_words)
            match = headings.match_headings(stacked, self.profile) if stacked else None
            if match is not None:
                printed.append(waiting.pop(0).printed(self.document_words))
            else:
                match = headings.match_headings(
                    band.texts(self.document_words), self.profile, loose=True
                )
        if match is None:
            split = self.split_at_headings(band)
            if split is None:
                return False
            above, match, remainder = split
            draft.head += [PrintedRow([line.text], page=band.page) for line in above]
            printed = [PrintedRow(match.titles, tuple(band.edges), page=band.page)]
            if remainder.words:
                waiting.insert(0, remainder)
        match.printed = printed
        draft.header, draft.edges = match, band.edges
        return True

    def rows_above_headings(self, band: Band) -> list[PrintedRow]:
        """Return a band above the headings as one row, or as one row per line.

        The variant with more recognized labels is chosen.
        """
        single = [PrintedRow([line.text], page=band.page) for line in lines(band.words)]
        as_one_row = [band.printed(self.document_words)]
        return (
            single
            if len(single) > 1
            and self.number_of_labelled_values(single)
            > self.number_of_labelled_values(as_one_row)
            else as_one_row
        )

    def number_of_labelled_values(self, rows: list[PrintedRow]) -> int:
        """Return the number of values with a known label."""
        labelled = (
            labels.parse_labels(" ".join(filter(None, row.lines)), self.profile)
            for row in rows
        )
        return sum(
            1 for parts in labelled for label in parts if label.what and label.value
        )

    def split_at_headings(
        self, band: Band
    ) -> tuple[list[TextLine], HeadingRow, Band] | None:
        """Split a band without rules between its rows: lines above the headings,
        headings, remainder.
        """
        lines_of_band = lines(band.words)
        for start in range(min(8, len(lines_of_band))):
            best: tuple[int, HeadingRow] | None = None
            for count in range(1, min(4, len(lines_of_band) - start) + 1):
                header = headings.match_headings(
                    band.of(lines_of_band[start : start + count]).texts(
                        self.document_words
                    ),
                    self.profile,
                )
                if header is not None and (
                    best is None or header.known >= best[1].known
                ):
                    best = count, header
            if best is not None:
                return (
                    lines_of_band[:start],
                    best[1],
                    band.of(lines_of_band[start + best[0] :]),
                )
        return None

    def add_rows(self, draft: TableDraft, band: Band, torn: bool) -> None:
        """Add the rows of a band. ``torn``: its first row may continue the last one."""
        assert draft.header is not None and draft.edges is not None
        header = draft.header
        if len(band.edges) < len(draft.edges):
            plain = Band(band.page, draft.edges, band.words)
            # Vertical rules separate only the headings.
            if bands.has_keys(plain, header):
                band = plain
        rows = bands.rows_of_band(
            bands.aligned_band(band, draft.edges), header, self.document_words, torn
        )
        # Keep its own cells, instead of those aligned with the headings.
        if len(rows) == 1:
            rows = [band.printed(self.document_words)]
        draft.rows += rows

    # Tables without vertical rules.

    def add_loose_piece(self, draft: TableDraft, piece: TablePiece) -> None:
        """Add a piece without vertical rules; its rows are added at the end."""
        draft.head += [PrintedRow([text], page=piece.box.page) for text in piece.head]
        if piece.columns is not None and draft.header is None:
            draft.header = piece.columns.header
        if draft.header is not None:
            self.loose_pieces.setdefault(id(draft), []).append(piece)

    def add_rows_of_loose_pieces(
        self, draft: TableDraft, pieces: list[TablePiece]
    ) -> None:
        """Add the rows of pieces without vertical rules, with columns found from all
        their lines.
        """
        spans = next(
            (piece.columns.spans for piece in pieces if piece.columns is not None), None
        )
        header = draft.header
        if spans is None or header is None:
            return
        body = [line for piece in pieces for line in piece.lines]
        for piece in pieces:
            own = (
                piece.columns.spans
                if piece.columns is not None and len(piece.columns.spans) == len(spans)
                else spans
            )
            edges = columns.boundaries(own, body, *piece.extent)
            for band in _bands(piece, edges):
                if not headings.repeats_headings(
                    band.texts(self.document_words), header, self.profile
                ):
                    rows = bands.rows_of_band(band, header, self.document_words)
                    for row in rows:
                        # Columns are found separately on each page: cells match by
                        # their index.
                        row.edges = ()
                    draft.rows += rows


def _bands(piece: TablePiece, edges: list[float]) -> list[Band]:
    """Return the bands of a piece, separated by rules or shading."""
    if not piece.lines or piece.page is None:
        return []
    top, bottom = piece.top, piece.lines[-1].bottom
    cuts = [
        top,
        *(y for y in row_marks(piece.page, edges[0], edges[-1]) if top < y < bottom),
        bottom + 1,
    ]
    parts = []
    for upper, lower in pairwise(cuts):
        words = [word for word in words_of(piece.lines) if upper <= word.middle < lower]
        if words:
            parts.append(Band(piece.page.number, edges, words))
    return parts


def _stacked(
    upper: Band, lower: Band, document_words: frozenset[str]
) -> list[str] | None:
    """Return the texts of two bands that form one heading row."""
    if len(upper.edges) != len(lower.edges):
        lower = bands.aligned_band(lower, upper.edges)
    above, below = upper.texts(document_words), lower.texts(document_words)
    return [" ".join(filter(None, pair)) for pair in zip(above, below, strict=True)]
