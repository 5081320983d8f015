//! What makes a file fit for archives, PDF/A-2b, or PDF/A-3b where it carries another file (ISO 19005-2 and -3): metadata, the
//! meaning of its colours, an identifier, and the file that it carries.

use miniz_oxide::deflate::compress_to_vec_zlib;
use pdf_writer::types::{AssociationKind, OutputIntentSubtype};
use pdf_writer::{Filter, Finish, Name, Pdf, Ref, Str, TextStr};
use sha2::{Digest, Sha256};

use super::colour::srgb_profile;
use crate::document::Attachment;
use crate::plot::Escaped;

/// Name of the program in a file.
pub(super) const PRODUCER: &str = "centrical";

/// The colours that a page without a colour space of its own has.
const CONDITION: &str = "sRGB IEC61966-2.1";

/// Places of what an archive needs.
pub(super) struct Archive {
    metadata: Ref,
    profile: Ref,
    /// The specification of the carried file, and its bytes.
    carried: Option<(Ref, Ref)>,
}

impl Archive {
    /// Writes what an archive needs of a file of this title.
    pub fn new(
        pdf: &mut Pdf,
        title: &str,
        attachment: Option<&Attachment>,
        level: u8,
        new: &mut impl FnMut() -> Ref,
    ) -> Self {
        let (metadata, profile) = (new(), new());
        pdf.metadata(metadata, xmp(title, attachment.is_some()).as_bytes());
        let icc = compress_to_vec_zlib(&srgb_profile(), level);
        pdf.icc_profile(profile, &icc).n(3).filter(Filter::FlateDecode);
        let carried = attachment.map(|attachment| {
            let (specification, bytes) = (new(), new());
            carry(pdf, attachment, level, (specification, bytes));
            (specification, bytes)
        });
        Self { metadata, profile, carried }
    }

    /// Names all of it in the catalog.
    pub fn enter(&self, catalog: &mut pdf_writer::writers::Catalog, attachment: Option<&Attachment>) {
        catalog.metadata(self.metadata);
        let mut intents = catalog.output_intents();
        let mut intent = intents.push();
        intent.subtype(OutputIntentSubtype::PDFA).output_condition_identifier(TextStr(CONDITION));
        intent.info(TextStr(CONDITION)).dest_output_profile(self.profile);
        intent.finish();
        intents.finish();
        if let Some(((specification, _), attachment)) = self.carried.zip(attachment) {
            catalog.names().embedded_files().names().insert(Str(attachment.name.as_bytes()), specification);
            catalog.insert(Name(b"AF")).array().item(specification);
        }
    }
}

/// The file identifier: of the content and nothing else, so that the same document has the same.
pub(super) fn identifier<'c>(content: impl IntoIterator<Item = &'c [u8]>) -> (Vec<u8>, Vec<u8>) {
    let hash = content.into_iter().fold(Sha256::new(), Sha256::chain_update).finalize();
    (hash[..16].to_vec(), hash[..16].to_vec())
}

fn carry(pdf: &mut Pdf, attachment: &Attachment, level: u8, (specification, bytes): (Ref, Ref)) {
    let packed = compress_to_vec_zlib(&attachment.bytes, level);
    let mut file = pdf.embedded_file(bytes, &packed);
    file.subtype(Name(attachment.media_type.as_bytes()));
    file.filter(Filter::FlateDecode);
    file.params().size(i32::try_from(attachment.bytes.len()).unwrap_or(i32::MAX));
    file.finish();
    let mut named = pdf.file_spec(specification);
    named.path(Str(attachment.name.as_bytes())).unic_file(TextStr(attachment.name));
    // The same results for machines.
    named.association_kind(AssociationKind::Alternative).embedded_file_with_unicode(bytes);
}

/// The metadata, which repeat the title and the producer of the file and say which standard it keeps.
fn xmp(title: &str, has_file: bool) -> String {
    let part = if has_file { 3 } else { 2 };
    format!(
        "<?xpacket begin=\"\u{feff}\" id=\"W5M0MpCehiHzreSzNTczkc9d\"?>\n\
         <x:xmpmeta xmlns:x=\"adobe:ns:meta/\"><rdf:RDF xmlns:rdf=\"http://www.w3.org/1999/02/22-rdf-syntax-ns#\">\n\
         <rdf:Description rdf:about=\"\" xmlns:dc=\"http://purl.org/dc/elements/1.1/\" \
         xmlns:pdf=\"http://ns.adobe.com/pdf/1.3/\" xmlns:pdfaid=\"http://www.aiim.org/pdfa/ns/id/\">\n\
         <pdfaid:part>{part}</pdfaid:part><pdfaid:conformance>B</pdfaid:conformance>\n\
         <dc:format>application/pdf</dc:format>\n\
         <dc:title><rdf:Alt><rdf:li xml:lang=\"x-default\">{}</rdf:li></rdf:Alt></dc:title>\n\
         <pdf:Producer>{PRODUCER}</pdf:Producer>\n\
         </rdf:Description></rdf:RDF></x:xmpmeta>\n<?xpacket end=\"r\"?>",
        Escaped(title)
    )
}
