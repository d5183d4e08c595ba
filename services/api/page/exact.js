// JSON with whole numbers beyond 2^53 as BigInt, so that seeds of 64 bits keep their digits. `parse` skips comments.

const TOKEN = /"(?:[^"\\]|\\.)*"|-?\d+(?:\.\d+)?(?:[eE][+-]?\d+)?/g;
const COMMENT = /"(?:[^"\\]|\\.)*"|\/\/.*/g;
const PLAIN_LIST = /\[\n\s*((?:[-+\d.eE]+|"[\w.-]+")(?:,\n\s*(?:[-+\d.eE]+|"[\w.-]+"))*)\n\s*\]/g;
// No text of JSON starts so: control characters are escaped in it.
const MARK = "\u0001whole:";

function isLarge(token) {
  return /^-?\d{16,}$/.test(token) && !Number.isSafeInteger(Number(token));
}

export function parse(written) {
  const text = written.replace(COMMENT, (token) => (token.startsWith("/") ? "" : token));
  if (!/\d{16}/.test(text)) return JSON.parse(text);
  const marked = text.replace(TOKEN, (token) => (isLarge(token) ? JSON.stringify(MARK + token) : token));
  return JSON.parse(marked, (_, value) => (typeof value === "string" && value.startsWith(MARK) ? BigInt(value.slice(MARK.length)) : value));
}

// With an indent, lists of numbers and short lists of names take one line. Strings have no line breaks, so that only such lists match.
export function print(value, indent = undefined) {
  const text = JSON.stringify(value, (_, one) => (typeof one === "bigint" ? MARK + one : one), indent);
  const exact = text?.replace(/"\\u0001whole:(-?\d+)"/g, "$1");
  return indent ? exact?.replace(PLAIN_LIST, (list, items) => (items.length > 200 ? list : `[${items.replace(/,\n\s*/g, ", ")}]`)) : exact;
}

// The number that a user typed: exact if it is whole, else the nearest double.
export function typed(text) {
  return isLarge(text.trim()) ? BigInt(text.trim()) : Number(text);
}

export function isNumber(value) {
  return typeof value === "number" || typeof value === "bigint";
}
