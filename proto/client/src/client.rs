//! Requests with typed responses.

use std::io::{BufRead, BufReader, Read};
use std::thread;
use std::time::Duration;

use serde::de::DeserializeOwned;
use ureq::unversioned::multipart::Form;

use crate::PAGE_ROWS;
use crate::error::ClientError;
use crate::http::{Http, HttpError, Reply};
use crate::pages::PagesRead;
use crate::query::with_query;
use crate::views::Page;

/// Long-polls wait up to a minute; anything beyond this is a dead connection.
const RESPONSE_LIMIT: Duration = Duration::from_secs(90);
/// The longest that the service itself works on one request.
const PATIENT_LIMIT: Duration = Duration::from_secs(3700);
/// Most bytes of lines: the failures of 10^6 frames.
const LINES_BYTES: u64 = 256 << 20;
/// Most rows of a list that is kept in memory.
const MOST_ROWS: usize = 1_000_000;
/// Attempts at a request while the service is overloaded.
const ATTEMPTS: u32 = 4;
/// The pause before the second attempt; each further one is twice as long.
const FIRST_PAUSE: Duration = Duration::from_millis(250);

/// A client of one service; cheap to clone, shared by threads.
#[derive(Clone)]
pub struct Client {
    http: Http,
    /// Receives the names of damaged rows that a list leaves out.
    on_damage: fn(&[String]),
}

/// The response to an upload.
pub struct Received<T> {
    /// The stored thing.
    pub value: T,
    /// Whether the request created it.
    pub is_new: bool,
}

#[allow(
    clippy::missing_errors_doc,
    reason = "every request fails with a `ClientError`"
)]
impl Client {
    /// A client of the service at this URL, with a bearer token if it requires one.
    #[must_use]
    pub fn new(server: &str, token: Option<&str>) -> Self {
        Self::from_http(Http::new(server, token, RESPONSE_LIMIT))
    }

    /// The same for requests that may take the service up to an hour.
    #[must_use]
    pub fn with_patience(server: &str, token: Option<&str>) -> Self {
        Self::from_http(Http::new(server, token, PATIENT_LIMIT))
    }

    fn from_http(http: Http) -> Self {
        Self {
            http,
            on_damage: |_| {},
        }
    }

    /// Calls `report` with the names of damaged rows that a list leaves out.
    #[must_use]
    pub fn with_damage_report(self, report: fn(&[String])) -> Self {
        Self {
            on_damage: report,
            ..self
        }
    }

    pub(crate) fn report_damage(&self, damaged: &[String]) {
        if !damaged.is_empty() {
            (self.on_damage)(damaged);
        }
    }

    /// The URL of the service.
    #[must_use]
    pub fn base(&self) -> &str {
        self.http.base()
    }

    /// Reads a view.
    pub fn get<T: DeserializeOwned>(&self, path: &str) -> Result<T, ClientError> {
        let reply = self.retry(|| self.http.get_document(path))?;
        read(path, &reply.bytes)
    }

    /// Reads a view; `None` for an unknown path.
    pub fn find<T: DeserializeOwned>(&self, path: &str) -> Result<Option<T>, ClientError> {
        match self.get(path) {
            Err(error) if error.is_not_found() => Ok(None),
            found => found.map(Some),
        }
    }

    /// Reads a file.
    pub fn get_bytes(&self, path: &str) -> Result<Vec<u8>, ClientError> {
        self.retry(|| self.http.get(path)).map(|reply| reply.bytes)
    }

    /// Reads lines of JSON as they arrive.
    pub fn lines<T: DeserializeOwned>(&self, path: &str) -> Result<Vec<T>, ClientError> {
        let stream = self.http.stream(path);
        let stream = stream.map_err(|error| ClientError::new(&self.http, error))?;
        let (mut lines, mut bytes) = (Vec::new(), 0);
        for line in BufReader::new(stream.take(LINES_BYTES + 1)).lines() {
            let broken = |error: std::io::Error| HttpError::Unreachable(error.into());
            let line = line.map_err(|error| ClientError::new(&self.http, broken(error)))?;
            bytes += line.len() as u64 + 1;
            if bytes > LINES_BYTES {
                return Err(ClientError::TooLong { limit: LINES_BYTES });
            }
            lines.push(read(path, line.as_bytes())?);
        }
        Ok(lines)
    }

    /// All rows of a paged list, up to a limit.
    pub fn rows<T: DeserializeOwned>(
        &self,
        path: &str,
        parameters: &[(&str, Option<&str>)],
        limit: usize,
    ) -> Result<Vec<T>, ClientError> {
        let (mut rows, mut cursor) = (Vec::new(), None::<String>);
        let mut read = PagesRead::default();
        while rows.len() < limit {
            let most = (limit - rows.len()).min(PAGE_ROWS).to_string();
            let page = [("limit", Some(most.as_str())), ("cursor", cursor.as_deref())];
            let page: Page<T> = self.get(&with_query(path, &[parameters, &page].concat()))?;
            self.report_damage(&page.damaged);
            cursor = read.follow(path, &page)?;
            rows.extend(page.items);
            if cursor.is_none() {
                break;
            }
            if rows.len() >= MOST_ROWS {
                return Err(ClientError::EndlessList {
                    path: path.to_owned(),
                    pages: rows.len() / PAGE_ROWS,
                });
            }
        }
        Ok(rows)
    }

    /// Sends JSON, and reads the view in the response.
    pub fn post<T: DeserializeOwned>(
        &self,
        path: &str,
        headers: &[(&str, &str)],
        body: &[u8],
    ) -> Result<T, ClientError> {
        let headers = [&[("content-type", "application/json")], headers].concat();
        let reply = self.retry(|| self.http.post(path, &headers, body))?;
        read(path, &reply.bytes)
    }

    /// Sends a form.
    pub fn post_form<'a, T: DeserializeOwned>(
        &self,
        path: &str,
        form: impl Fn() -> Form<'a>,
    ) -> Result<Received<T>, ClientError> {
        let reply = self.retry(|| self.http.post(path, &[], form()))?;
        Ok(Received {
            value: read(path, &reply.bytes)?,
            is_new: reply.status.as_u16() == 201,
        })
    }

    /// Deletes the thing at a path; `None` for an empty response.
    pub fn delete<T: DeserializeOwned>(&self, path: &str) -> Result<Option<T>, ClientError> {
        let reply = self.received(self.http.delete(path))?;
        match reply.bytes.as_slice() {
            [] => Ok(None),
            body => read(path, body).map(Some),
        }
    }

    /// Repeats a request while the service is overloaded, which rejects requests before they have an effect.
    fn retry(&self, send: impl Fn() -> Result<Reply, HttpError>) -> Result<Reply, ClientError> {
        let mut pause = FIRST_PAUSE;
        for _ in 1..ATTEMPTS {
            match send() {
                Err(HttpError::Problem(problem)) if problem.is_temporary() => thread::sleep(pause),
                response => return self.received(response),
            }
            pause *= 2;
        }
        self.received(send())
    }

    fn received(&self, response: Result<Reply, HttpError>) -> Result<Reply, ClientError> {
        response.map_err(|error| ClientError::new(&self.http, error))
    }
}

fn read<T: DeserializeOwned>(path: &str, body: &[u8]) -> Result<T, ClientError> {
    serde_json::from_slice(body).map_err(|source| ClientError::Unreadable {
        path: path.to_owned(),
        source,
    })
}
