"""Reads an HTML page with a strict XML parser (expat) and with html.parser, and prints what it holds: a line for
each element of content, `name|attributes|text`, and the bytes of data: URLs into files.

  read_page.py PAGE FOLDER

Ends with status 1 when the page is not well-formed XML or the two parsers see different pages.
"""
import base64
import html.parser
import pathlib
import sys
import xml.parsers.expat


class Events:
    def __init__(self):
        self.open, self.found = [], []

    def start(self, name, attributes):
        entry = [name, {key.lower(): value for key, value in dict(attributes).items()}, ""]  # HTML ignores case
        self.open.append(entry)
        self.found.append(entry)

    def end(self, name):
        entry = self.open.pop()
        if entry[0] != name:
            sys.exit(f"</{name}> ends <{entry[0]}>")

    def text(self, words):
        if self.open:
            self.open[-1][2] += words


def read_as_xml(page):
    events = Events()
    parser = xml.parsers.expat.ParserCreate("utf-8")
    parser.buffer_text = True
    parser.StartElementHandler, parser.EndElementHandler = events.start, events.end
    parser.CharacterDataHandler = events.text
    parser.Parse(page, True)
    return events.found


class HtmlReader(html.parser.HTMLParser):
    def __init__(self):
        super().__init__(convert_charrefs=True)
        self.events = Events()
        self.handle_starttag = lambda name, attributes: self.events.start(name, attributes)
        self.handle_endtag = lambda name: self.events.end(name)
        # To HTML the marks by which XML finds the end of a script are text, within comments of the script.
        self.handle_data = lambda words: self.events.text(
            words.replace("<![CDATA[", "").replace("]]>", "") if self.cdata_elem == "script" else words)


def read_as_html(page):
    reader = HtmlReader()
    reader.feed(page.decode("utf-8"))
    reader.close()
    if reader.events.open:
        sys.exit(f"never closed: {reader.events.open}")
    return reader.events.found


def main():
    page, folder = pathlib.Path(sys.argv[1]).read_bytes(), pathlib.Path(sys.argv[2])
    found = read_as_xml(page)
    if found != read_as_html(page):
        sys.exit("XML and HTML parsers see different pages")
    policies = [attributes["content"] for name, attributes, _ in found
                if name == "meta" and attributes.get("http-equiv") == "Content-Security-Policy"]
    if len(policies) != 1 or not policies[0].startswith("default-src 'none';") or "http" in policies[0]:
        sys.exit("no policy forbids the page to ask for the network")
    for name, attributes, text in found:
        if name == "script" and attributes.get("type", "") == "":
            text = f"{len(text)} characters"  # of three.js, which names XML's own http: name; the policy binds it
        source = attributes.pop("src", None)
        if source is not None:
            head, data = source.split(",", 1)
            attributes["src"] = head
            (folder / f"data_{name}").write_bytes(base64.b64decode(data, validate=True))
        if any(url in f"{attributes}{text}" for url in ("http:", "https:", "url(", "@import")):
            sys.exit(f"<{name}> asks for the network")
        words = " ".join(f"{key}={value}" for key, value in attributes.items())
        print("|".join(part.encode("unicode_escape").decode() for part in (name, words, text)))


main()
