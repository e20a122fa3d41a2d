//! Unpacking of gzip: several members are one stream, and zeros behind the last one are padding.
//!
//! Source: RFC 1952, section 2.2; the manual of GNU gzip on files padded to blocks with zeros.

use super::decoder::Guarded;
use flate2::bufread::GzDecoder;
use std::io::{self, BufRead, Read};

/// First bytes of a stream.
pub const MAGIC: [u8; 2] = [0x1f, 0x8b];

/// The content of a gzip stream; a panic of its decoder is an error.
pub struct Unpacked<R>(Option<Guarded<GzDecoder<R>>>);

impl<R: BufRead> Unpacked<R> {
    /// The content of what is left of `packed`.
    pub fn new(packed: R) -> Unpacked<R> {
        Unpacked(Some(Guarded(GzDecoder::new(packed))))
    }
}

impl<R: BufRead> Read for Unpacked<R> {
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        while let Some(member) = &mut self.0 {
            let count = member.read(bytes)?;
            if count > 0 || bytes.is_empty() {
                return Ok(count);
            }
            let packed = member.0.get_mut();
            let padding = skip_zeros(packed)?;
            if packed.fill_buf()?.is_empty() {
                break;
            }
            if padding {
                return Err(io::Error::other(
                    "zeros and then other bytes follow its end",
                ));
            }
            self.0 = self
                .0
                .take()
                .map(|ended| Guarded(GzDecoder::new(ended.0.into_inner())));
        }
        Ok(0)
    }
}

/// Reads past zeros; true if there are any.
fn skip_zeros(source: &mut impl BufRead) -> io::Result<bool> {
    let mut any = false;
    loop {
        let buffer = source.fill_buf()?;
        let zeros = buffer.iter().take_while(|byte| **byte == 0).count();
        if zeros == 0 {
            return Ok(any);
        }
        any = true;
        source.consume(zeros);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Write;

    fn packed(bytes: &[u8]) -> Vec<u8> {
        let mut encoder = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
        encoder.write_all(bytes).unwrap();
        encoder.finish().unwrap()
    }

    fn unpacked(parts: &[&[u8]]) -> Result<Vec<u8>, String> {
        let mut bytes = Vec::new();
        let read = Unpacked::new(&parts.concat()[..]).read_to_end(&mut bytes);
        read.map(|_| bytes).map_err(|error| error.to_string())
    }

    #[test]
    fn members_are_one_stream_and_zeros_behind_them_padding() {
        let (one, two) = (packed(b"12"), packed(b"345"));
        let whole = Ok(b"12345".to_vec());
        assert_eq!(unpacked(&[&one, &two]), whole);
        assert_eq!(unpacked(&[&one, &packed(b""), &two, &[0]]), whole);
        assert_eq!(unpacked(&[&one, &two, &[0; 70_000]]), whole);
        for behind in [&b"x"[..], b"\0\0x", &two[..4], &one[..9]] {
            assert!(unpacked(&[&one, behind]).is_err(), "{behind:?}");
        }
        assert!(unpacked(&[&[0; 4], &one]).is_err());
        assert!(unpacked(&[&one, &[0], &two]).is_err());
    }
}
