//! `Table`: columns with units, and rows computed while they are written.

use std::io::{self, Write};

/// One number of a table.
#[derive(Clone, Copy)]
pub enum Cell {
    /// An integer, written without a decimal point.
    Count(u64),
    /// A number with 17 significant digits; NaN is written as `NaN`, in JSON as null.
    Number(f64),
}

/// Named columns with units, and the rows under them.
pub struct Table<'a> {
    /// Name of the solution, for JSON.
    pub solution: &'static str,
    /// Name and unit of every column.
    pub columns: Vec<(&'static str, &'static str)>,
    /// Rows with one cell per column.
    pub rows: Box<dyn Iterator<Item = Vec<Cell>> + 'a>,
}

impl Table<'_> {
    /// A row of names, a row of units, then numbers, as in the other CSV files of jamscope.
    pub fn write_csv(self, output: &mut impl Write) -> io::Result<()> {
        let (names, units): (Vec<_>, Vec<_>) = self.columns.iter().copied().unzip();
        writeln!(output, "{}\n{}", names.join(","), units.join(","))?;
        for row in self.rows {
            let cells: Vec<String> = row.into_iter().map(csv).collect();
            writeln!(output, "{}", cells.join(","))?;
        }
        output.flush()
    }

    /// `{"solution": …, "columns": [{"name": …, "unit": …}, …], "rows": [[…], …]}`, one row per line.
    pub fn write_json(self, output: &mut impl Write) -> io::Result<()> {
        let column = |(name, unit): &(&str, &str)| serde_json::json!({ "name": name, "unit": unit });
        let columns: Vec<serde_json::Value> = self.columns.iter().map(column).collect();
        let columns = serde_json::Value::from(columns);
        write!(output, "{{\n\"solution\": \"{}\",\n\"columns\": {columns},\n\"rows\": [", self.solution)?;
        for (index, row) in self.rows.enumerate() {
            let cells: Vec<String> = row.into_iter().map(json).collect();
            write!(output, "{}\n[{}]", if index > 0 { "," } else { "" }, cells.join(", "))?;
        }
        writeln!(output, "\n]\n}}")?;
        output.flush()
    }
}

fn csv(cell: Cell) -> String {
    match cell {
        Cell::Count(count) => count.to_string(),
        Cell::Number(number) => format!("{number:.16e}"),
    }
}

fn json(cell: Cell) -> String {
    match cell {
        Cell::Number(number) if !number.is_finite() => "null".into(),
        cell => csv(cell),
    }
}
