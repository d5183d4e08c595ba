-- A repeated submission is recognized by its description.

CREATE INDEX jobs_by_description ON jobs (spec_digest);
