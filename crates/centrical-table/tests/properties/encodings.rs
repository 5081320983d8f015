//! A table is the same one in every encoding, with whatever stands above it.

use std::fmt::Write as _;
use std::fs;

use centrical_table::{ColumnName, DecimalSign, Extent, Field, Rule, StampKind, TableReader, TextEncoding, text_form};

use crate::record::Record;

const NAMES: [&str; 4] = ["Время", "Ускорение 1", "Ускорение 2", "Ускорение 3"];
const WESTERN: [&str; 4] = ["Zeit", "Beschleunigung für x", "µ", "Größe °3"];

fn rows() -> Record {
    let column = |scale: f64| (0..9000).map(|i| f64::from(i) * scale).collect();
    [column(0.125), column(0.5), column(-0.25), column(1.0)]
}

/// The rows as text, with a delimiter and a decimal sign.
fn text(names: [&str; 4], delimiter: &str, sign: &str, above: &str, end: &str) -> String {
    let rows = rows();
    let mut text = format!("{above}{}{end}", names.join(delimiter));
    for k in 0..rows[0].len() {
        let row: Vec<String> = rows.iter().map(|column| column[k].to_string().replace('.', sign)).collect();
        write!(text, "{}{end}", row.join(delimiter)).unwrap();
    }
    text
}

fn utf_16(text: &str, bytes: fn(u16) -> [u8; 2]) -> Vec<u8> {
    text.encode_utf16().flat_map(bytes).collect()
}

fn read(bytes: &[u8], names: [&str; 4], extent: Extent) -> Result<Record, String> {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("record.csv");
    fs::write(&file, bytes).unwrap();
    let fields = names.map(|name| Field {
        name: ColumnName::Name(name.to_owned()),
        expected: "a number".to_owned(),
        rule: Rule::Any,
    });
    let mut record = Record::default();
    let mut table = TableReader::open(&file, extent, &fields, "a record").map_err(|e| e.to_string())?;
    while let Some(batch) = table.next_batch().map_err(|e| e.to_string())? {
        for rows in batch {
            record.iter_mut().zip(rows).for_each(|(column, values)| column.extend_from_slice(values));
        }
    }
    Ok(record)
}

#[test]
fn every_encoding_gives_the_same_rows() {
    for above in ["", "Прибор;ТА-200;;\r\nДата;05.10.2026;;\r\n\r\n"] {
        for (delimiter, sign) in [(";", ","), ("\t", ","), (",", "."), (";", ".")] {
            for end in ["\n", "\r\n"] {
                let text = text(NAMES, delimiter, sign, above, end);
                let kinds = [
                    text.clone().into_bytes(),
                    format!("\u{feff}{text}").into_bytes(),
                    encoding_rs::WINDOWS_1251.encode(&text).0.into_owned(),
                    utf_16(&text, u16::to_le_bytes),
                    utf_16(&text, u16::to_be_bytes),
                    utf_16(&format!("\u{feff}{text}"), u16::to_le_bytes),
                    utf_16(&format!("\u{feff}{text}"), u16::to_be_bytes),
                ];
                for (k, bytes) in kinds.iter().enumerate() {
                    assert_eq!(read(bytes, NAMES, Extent::Whole).as_ref(), Ok(&rows()), "{k} {delimiter:?} {sign}");
                }
            }
        }
    }
    let western = text(WESTERN, "\t", ",", "", "\r\n");
    let bytes = encoding_rs::WINDOWS_1252.encode(&western).0;
    assert_eq!(read(&bytes, WESTERN, Extent::Whole), Ok(rows()));
}

#[test]
fn growing_text_in_utf_16_ends_with_its_last_whole_line() {
    let text = text(NAMES, ";", ",", "", "\r\n");
    let bytes = utf_16(&format!("\u{feff}{text}"), u16::to_le_bytes);
    let read = read(&bytes[..bytes.len() - 7], NAMES, Extent::Growing).unwrap();
    assert_eq!(read[0], rows()[0][..8999]);
}

#[test]
fn other_words_may_be_in_any_encoding() {
    let mut bytes = b"t;a;b;c;note\n".to_vec();
    for _ in 0..100 {
        bytes.extend_from_slice(b"1;2;3;4;\xb5 \xc4\xe0\n");
    }
    let record = read(&bytes, ["t", "a", "b", "c"], Extent::Whole).unwrap();
    assert_eq!(record[3], [4.0; 100]);
}

#[test]
fn the_form_of_a_text_is_seen() {
    let text = "Рекордер;7\r\nДата;05.10.2026\r\nВремя;X;Y;Z\r\n;м/с²;g;[В]\r\n\
                05.10.2026 09:10:00,0100;0,5;1;2\r\n05.10.2026 09:10:00,0200;0,5;1;2\r\n";
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("record.txt");
    fs::write(&file, utf_16(text, u16::to_le_bytes)).unwrap();
    let form = text_form(&file).unwrap().unwrap();
    assert_eq!(form.encoding, TextEncoding::Utf16Le);
    assert_eq!((form.delimiter, form.decimal), (';', DecimalSign::Comma));
    assert_eq!((form.header_line, form.units_line, form.first_row_line), (Some(3), Some(4), 5));
    assert_eq!(form.above, ["Рекордер;7", "Дата;05.10.2026"]);
    assert_eq!(form.names, ["Время", "X", "Y", "Z"]);
    assert_eq!(form.units, [None, Some("m/s^2"), Some("g"), Some("V")]);
    let stamps = form.stamps.unwrap();
    assert_eq!((stamps.column, stamps.kind), (0, StampKind::DayFirst));
    fs::write(&file, "no table\nat all\n").unwrap();
    assert_eq!(text_form(&file).unwrap(), None);
}

#[test]
fn trailing_delimiters_of_spreadsheets() {
    let text = "t;a;b;c\n0;1;2;3;;;\n1;1;2;3;;;\n;;;;;;\n2;1;2;3;;;\n;;;;;;";
    assert_eq!(read(text.as_bytes(), ["t", "a", "b", "c"], Extent::Whole).unwrap()[0], [0.0, 1.0, 2.0]);
    let text = "t;a;b;c;;;\n0;1;2;3;;;\n1;1;2;3;;;";
    assert_eq!(read(text.as_bytes(), ["t", "a", "b", "c"], Extent::Whole).unwrap()[0], [0.0, 1.0]);
}

#[test]
fn a_measurement_file_of_labview() {
    let text = "LabVIEW Measurement\t\r\nWriter_Version\t2\r\nSeparator\tTab\r\nDecimal_Separator\t,\r\n\
                Date\t2026/10/05\r\nTime\t10:00:00,0000000\r\n***End_of_Header***\t\r\n\t\r\nChannels\t3\t\t\t\r\n\
                Samples\t2\t2\t2\t\r\nY_Unit_Label\tVolts\tVolts\tVolts\t\r\nX0\t0,0\t0,0\t0,0\t\r\n\
                Delta_X\t0,5\t0,5\t0,5\t\r\n***End_of_Header***\t\t\t\t\r\n\
                X_Value\tU\tU 1\tU 2\tComment\r\n0,0\t1,5\t2,5\t3,5\r\n0,5\t1,5\t2,5\t3,5\r\n";
    let record = read(text.as_bytes(), ["X_Value", "U", "U 1", "U 2"], Extent::Whole).unwrap();
    assert_eq!(record, [vec![0.0, 0.5], vec![1.5; 2], vec![2.5; 2], vec![3.5; 2]]);
}
