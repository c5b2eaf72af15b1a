//! Text in lines that fit a terminal: aligned cells, broken sentences and lists.

/// Width of a terminal, in characters, which lines keep to if their cells allow it.
pub(crate) const TEXT_WIDTH: usize = 80;

/// Blanks between two columns.
const GAP: &str = "  ";

/// Rows of cells as lines whose columns are as wide as their widest cell.
///
/// Columns that do not fit in [`TEXT_WIDTH`] follow in further blocks of lines, each of which repeats the first
/// `keys` columns. A row without text in the other cells of a further block is left out of it.
pub(crate) fn aligned(rows: &[Vec<String>], keys: usize) -> String {
    let widths = widths(rows);
    let blocks: Vec<String> = blocks(&widths, keys)
        .iter()
        .map(|columns| block(rows, &widths, columns, keys))
        .collect();
    blocks.join("\n")
}

/// Fewest characters of a line of a folded cell.
const LEAST_FOLDED: usize = 12;

/// Rows whose last cells are broken at blanks into further rows, so that they fit in [`TEXT_WIDTH`].
pub(crate) fn folded(rows: Vec<Vec<String>>) -> Vec<Vec<String>> {
    let widths = widths(&rows);
    let Some((_, others)) = widths.split_last() else {
        return rows;
    };
    let taken: usize = others.iter().map(|width| width + GAP.len()).sum();
    let width = TEXT_WIDTH.saturating_sub(taken).max(LEAST_FOLDED);
    let mut out = Vec::new();
    for mut row in rows {
        let last = row.pop().unwrap_or_default();
        for line in joined(last.split(' '), " ", "", width).split('\n') {
            let line = std::iter::once(line.to_owned());
            out.push(
                std::mem::replace(&mut row, vec![String::new(); others.len()])
                    .into_iter()
                    .chain(line)
                    .collect(),
            );
        }
    }
    out
}

/// Width of each column, characters.
fn widths(rows: &[Vec<String>]) -> Vec<usize> {
    let mut widths = Vec::new();
    for row in rows {
        widths.resize(widths.len().max(row.len()), 0);
        for (width, cell) in widths.iter_mut().zip(row) {
            *width = cell.chars().count().max(*width);
        }
    }
    widths
}

/// The columns of each block: the first `keys`, and as many of the others as fit.
fn blocks(widths: &[usize], keys: usize) -> Vec<Vec<usize>> {
    let keys = keys.min(widths.len());
    let of_keys = widths[..keys].iter().map(|width| width + GAP.len()).sum();
    let begun: Vec<usize> = (0..keys).collect();
    let mut blocks = Vec::new();
    let mut block = begun.clone();
    let mut taken: usize = of_keys;
    for (column, width) in widths.iter().enumerate().skip(keys) {
        if block.len() > keys && taken + width > TEXT_WIDTH {
            blocks.push(std::mem::replace(&mut block, begun.clone()));
            taken = of_keys;
        }
        block.push(column);
        taken += width + GAP.len();
    }
    blocks.push(block);
    blocks
}

/// The lines of one block.
fn block(rows: &[Vec<String>], widths: &[usize], columns: &[usize], keys: usize) -> String {
    let further = columns.get(keys).is_some_and(|column| *column > keys);
    let filled = |row: &&Vec<String>| {
        let cells = columns
            .iter()
            .skip(keys)
            .filter_map(|&column| row.get(column));
        !further || cells.into_iter().any(|cell| !cell.is_empty())
    };
    let mut out = String::new();
    for row in rows.iter().filter(filled) {
        let cells: Vec<String> = columns
            .iter()
            .filter_map(|&column| Some((row.get(column)?, widths[column])))
            .map(|(cell, width)| format!("{cell:<width$}"))
            .collect();
        out.push_str(cells.join(GAP).trim_end());
        out.push('\n');
    }
    out
}

/// Text with its lines broken at blanks to at most 80 characters. Lines that fit stay as they are, and words that are
/// longer are not cut.
#[must_use]
pub fn wrapped(text: &str) -> String {
    let lines = text.split('\n');
    let lines: Vec<String> = lines
        .map(|line| joined(line.split(' '), " ", "", TEXT_WIDTH))
        .collect();
    lines.join("\n")
}

/// Lines of text for each note.
pub(crate) fn note_lines<'a>(notes: impl IntoIterator<Item = &'a String>) -> String {
    let notes = notes.into_iter();
    notes
        .map(|note| format!("{}\n", wrapped(&format!("note: {note}"))))
        .collect()
}

/// One paragraph whose lines all begin with `indent`.
pub(crate) fn indented(text: &str, indent: &str) -> String {
    joined(
        format!("{indent}{text}").split(' '),
        " ",
        indent,
        TEXT_WIDTH,
    )
}

/// `heading`, then items with commas between them. Items that do not fit into the line begin a new one, set in by
/// two blanks.
pub(crate) fn listed(heading: &str, items: &[String]) -> String {
    let last = items.len().saturating_sub(1);
    let items = items.iter().enumerate().map(|(i, item)| {
        let comma = if i < last { "," } else { "" };
        format!("{item}{comma}")
    });
    let items: Vec<String> = std::iter::once(heading.to_owned()).chain(items).collect();
    joined(items.iter().map(String::as_str), GAP, GAP, TEXT_WIDTH)
}

/// Pieces with `gap` between them, in lines of at most `most` characters whose further ones begin with `indent`.
fn joined<'a>(
    pieces: impl Iterator<Item = &'a str>,
    gap: &str,
    indent: &str,
    most: usize,
) -> String {
    let mut out = String::new();
    let mut taken = 0;
    for (i, piece) in pieces.enumerate() {
        let width = piece.chars().count();
        if i > 0 && taken + gap.len() + width > most {
            out.push('\n');
            out.push_str(indent);
            taken = indent.len();
        } else if i > 0 {
            out.push_str(gap);
            taken += gap.len();
        }
        out.push_str(piece);
        taken += width;
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rows(text: &[&[&str]]) -> Vec<Vec<String>> {
        let cells = |row: &&[&str]| row.iter().map(|cell| (*cell).to_owned()).collect();
        text.iter().map(cells).collect()
    }

    #[test]
    fn columns_are_as_wide_as_their_widest_cell() {
        let text = aligned(&rows(&[&["a", "bbb", "c"], &["aaaa", "b", "-"], &["a"]]), 1);
        assert_eq!(text, "a     bbb  c\naaaa  b    -\na\n");
        assert_eq!(aligned(&[], 1), "");
    }

    #[test]
    fn columns_that_do_not_fit_follow_below_with_the_first_repeated() {
        let wide = "x".repeat(40);
        let text = aligned(
            &rows(&[
                &["model", "first", "second", "third"],
                &["smith", &wide, &wide, "3"],
                &["only", "1"],
            ]),
            1,
        );
        assert_eq!(
            text,
            format!(
                "model  first\nsmith  {wide}\nonly   1\n\nmodel  {0:<40}  third\nsmith  {wide}  3\n",
                "second"
            )
        );
        let longest = text.lines().map(str::len).max();
        assert!(longest <= Some(TEXT_WIDTH), "{text}");
        let text = aligned(
            &rows(&[&["a", "b", &wide, &wide], &["1", "2", "3", "4"]]),
            2,
        );
        assert_eq!(
            text,
            format!("a  b  {wide}\n1  2  3\n\na  b  {wide}\n1  2  4\n")
        );
        // A cell that is wider than a line is not cut.
        let wider = "y".repeat(100);
        assert!(aligned(&rows(&[&["a", &wider]]), 1).contains(&wider));
    }

    #[test]
    fn last_cells_that_do_not_fit_go_on_below() {
        let value = "x".repeat(50);
        let text = rows(&[
            &["name", "value", "meaning"],
            &["a", &value, "one two three four five"],
        ]);
        let text = aligned(&folded(text), 1);
        let blank = " ".repeat(58);
        assert_eq!(
            text,
            format!(
                "name  {:<50}  meaning\na     {value}  one two three four\n{blank}five\n",
                "value"
            )
        );
        let fits = rows(&[&["a", "b c"]]);
        assert_eq!(folded(fits.clone()), fits);
        assert!(folded(Vec::new()).is_empty());
    }

    #[test]
    fn text_is_broken_at_blanks_and_between_items() {
        let text = wrapped(&"word ".repeat(40));
        assert!(text.lines().all(|line| line.len() <= TEXT_WIDTH), "{text}");
        assert_eq!(text.split_whitespace().count(), 40);
        let fits = "a  b\n\n  c   d \n";
        assert_eq!(wrapped(fits), fits);
        let text = indented(&"word ".repeat(40), "  ");
        assert!(text.lines().all(|line| line.starts_with("  word")));
        assert!(text.lines().all(|line| line.len() <= TEXT_WIDTH), "{text}");
        let items: Vec<String> = (0..20).map(|i| format!("{i}: 0.5 +- 0.1")).collect();
        let text = listed("orders", &items);
        assert!(text.starts_with("orders  0: 0.5 +- 0.1,  1: "), "{text}");
        assert!(text.lines().all(|line| line.len() <= TEXT_WIDTH), "{text}");
        assert!(text.lines().skip(1).all(|line| line.starts_with("  ")));
        assert_eq!(listed("none", &[]), "none");
    }
}
