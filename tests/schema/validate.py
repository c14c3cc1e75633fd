"""Judges scenes by a JSON Schema: validate.py valid|invalid SCHEMA SCENE...

Exits 0 when every scene is judged as the first argument says, and prints those that are not.
"""

import json
import sys

import jsonschema
import yaml

expected_valid = sys.argv[1] == "valid"
with open(sys.argv[2], encoding="utf-8") as stream:
    schema = json.load(stream)
jsonschema.Draft7Validator.check_schema(schema)
validator = jsonschema.Draft7Validator(schema)

wrong = 0
for path in sys.argv[3:]:
    with open(path, encoding="utf-8-sig") as stream:
        errors = list(validator.iter_errors(yaml.safe_load(stream)))
    if bool(errors) == expected_valid:
        wrong += 1
        print(f"{path}: expected to be {sys.argv[1]}")
        for error in errors:
            print(f"  at {'/'.join(map(str, error.path))}: {error.message[:200]}")
sys.exit(1 if wrong or len(sys.argv) < 4 else 0)
