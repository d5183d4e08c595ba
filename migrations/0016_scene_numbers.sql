-- Numbers of a scene as they were given.
ALTER TABLE scenes ADD COLUMN hfov_deg REAL; -- the focal length was computed from it
ALTER TABLE scenes ADD COLUMN scale REAL;    -- factor from the floats of the picture to linear light
