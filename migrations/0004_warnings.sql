-- Whether an image was rendered with warnings, beside its parameters: every page answers it, and had to read and parse
-- the whole record for it.

ALTER TABLE images ADD COLUMN warnings INTEGER NOT NULL DEFAULT 0;
UPDATE images SET warnings = json_array_length(records.record, '$.warnings')
  FROM records
 WHERE records.job_id = images.job_id AND records.frame = images.frame
   AND json_array_length(records.record, '$.warnings') > 0;
