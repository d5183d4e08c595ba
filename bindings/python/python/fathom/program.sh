#!/bin/sh
exec "$FATHOM_PYTHON" -m fathom "$@"
