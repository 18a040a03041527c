//! Where the tokens of an expanded model come from: a file, a place in it, and the chain of uses that put
//! them there.
//!
//! A span of the expanded model counts entries of one list. The tokens of each file that is read take
//! consecutive entries, and so do the tokens of the expanded model; a span of several entries is the place
//! from the first to the last.

use crate::span::Span;

/// A place in a file.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Place {
    /// the file: 0 is that of the mechanism
    pub file: u32,
    /// where in its text, as its own spans count
    pub span: Span,
    /// the use of a part through which it belongs to the mechanism; absent outside of parts
    pub site: Option<u32>,
}

/// A use of a part.
#[derive(Clone, Debug)]
pub struct Site {
    /// the name of the part
    pub part: String,
    /// where the use stands; itself perhaps within a part
    pub place: Place,
    /// a span of that place
    pub span: Span,
}

/// All places.
#[derive(Clone, Debug, Default)]
pub struct Places {
    list: Vec<Place>,
    sites: Vec<Site>,
}

impl Places {
    /// A span for one place.
    pub fn add(&mut self, place: Place) -> Span {
        let start = self.list.len() as u32;
        self.list.push(place);
        Span { start, end: start + 1 }
    }

    /// Notes the use of a part at a place.
    pub fn add_site(&mut self, part: String, place: Place) -> u32 {
        let span = self.add(place);
        self.sites.push(Site { part, place, span });
        (self.sites.len() - 1) as u32
    }

    /// The place of a span: from its first entry to its last, or the first alone where these belong to
    /// different files or uses.
    pub fn find(&self, span: Span) -> Option<Place> {
        let first = *self.list.get(span.start as usize)?;
        let last = (span.end as usize).checked_sub(1).and_then(|end| self.list.get(end)).unwrap_or(&first);
        if (last.file, last.site) == (first.file, first.site) && last.span >= first.span {
            return Some(Place { span: first.span.to(last.span), ..first });
        }
        Some(first)
    }

    /// The place of a span of a file's own tokens, as part of a use.
    pub fn within(&self, span: Span, site: Option<u32>) -> Place {
        Place { site, ..self.find(span).unwrap_or_default() }
    }

    /// The uses around a place, from the innermost.
    pub fn sites(&self, place: Place) -> Vec<&Site> {
        let mut found = Vec::new();
        let mut next = place.site;
        while let Some(site) = next.and_then(|site| self.sites.get(site as usize)) {
            found.push(site);
            next = site.place.site;
        }
        found
    }
}
