// Colours of the page, which follow light and dark surroundings, and its numbers in words.

/** The page's colour of a name such as "--ink", as CSS has it. */
function pageColour(name) {
  return getComputedStyle(document.documentElement).getPropertyValue(name).trim();
}

/** The same as three numbers in [0, 1], of sRGB. */
function pageColourNumbers(name) {
  const colour = new THREE.Color(pageColour(name));
  const numbers = { r: 0, g: 0, b: 0 };
  colour.getRGB(numbers, THREE.SRGBColorSpace);
  return [numbers.r, numbers.g, numbers.b];
}

/** 1, 2 or 5 times a power of ten, not above `value`. */
function roundNumberBelow(value) {
  const power = 10 ** Math.floor(Math.log10(value));
  for (const factor of [5, 2]) if (factor * power <= value * (1 + 1e-9)) return factor * power;
  return power;
}

/** Millimetres under a metre, as everywhere in the page. */
function lengthInWords(length_m) {
  const text = (value) => String(Number(value.toPrecision(4)));
  return Math.abs(length_m) < 1 ? `${text(1000 * length_m)} mm` : `${text(length_m)} m`;
}

/** An element with a class and a text. */
function element(kind, className, text) {
  const made = document.createElement(kind);
  if (className) made.className = className;
  if (text) made.textContent = text;
  return made;
}
