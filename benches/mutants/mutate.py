"""One-line mutants of Rust source that is formatted by rustfmt, and the text in which all of them stand side by side behind a switch.

A mutant replaces one token of a function body. Its slot is the smallest expression or statement around it:

    let overlap = reach - distance;
    let overlap = (if crate::switch::on(7) { reach + distance } else { reach - distance });

so that many mutants are compiled once, and a run chooses one of them (mutant schemata: Untch, Offutt, Harrold (1993), ISSTA 18, 139).
"""

import re
from dataclasses import dataclass

TOKEN = re.compile(
    r"""(?P<space>\s+|//[^\n]*|/\*.*?\*/)
    |(?P<string>b?r(?P<hashes>\#*)".*?"(?P=hashes)|b?"(?:\\.|[^"\\])*"|b?'(?:\\(?:x..|u\{[^}]*\}|.)|[^'\\\n])')
    |(?P<lifetime>'[A-Za-z_]\w*)
    |(?P<number>\d[\d_]*(?:\.\d[\d_]*)?(?:[eE][+-]?\d+)?(?:_?[fiu](?:8|16|32|64|size))?)
    |(?P<word>[A-Za-z_]\w*)
    |(?P<sign>\.\.=|\.\.\.|<<=|>>=|->|=>|==|!=|<=|>=|&&|\|\||\+=|-=|\*=|/=|%=|\^=|&=|\|=|::|\.\.|<<|[^\s\w])""",
    re.S | re.X,
)
SWAPS = {"+": "-", "-": "+", "*": "/", "/": "*", "<": "<=", "<=": "<", ">": ">=", ">=": ">", "==": "!=", "!=": "==", "&&": "||",
         "||": "&&", "+=": "-=", "-=": "+=", "*=": "/=", "/=": "*="}
NUMBERS = {"0": "1", "1": "2", "2": "1", "0.0": "1.0", "1.0": "2.0", "2.0": "1.0", "0.5": "1.0"}
WORDS = {"min": "max", "max": "min", "true": "false", "false": "true"}
OPEN, CLOSE = {"(": ")", "[": "]", "{": "}"}, {")", "]", "}"}
# What a unary sign can follow.
BEFORE_UNARY = {"(", "[", "{", ",", ";", "=", "=>", "return", "+", "-", "*", "/", "<", ">", "<=", ">=", "==", "!=", "&&", "||", "|", "+=",
                "-=", "*=", "/=", ":", "if", "while", "else", "in", "}", "!", "..", "match"}
# Arguments of these macros are messages or checks of the program itself.
MESSAGES = {"assert", "assert_eq", "debug_assert", "debug_assert_eq", "panic", "unreachable", "write", "writeln", "format", "println"}
STATEMENTS = {"let", "const", "static", "use", "fn", "impl", "struct", "enum", "type", "for", "loop", "mod", "trait", "pub"}


@dataclass
class Token:
    kind: str
    text: str
    start: int
    end: int


@dataclass
class Mutant:
    file: str
    line: int
    change: str
    # The slot, and the text that replaces it.
    start: int
    end: int
    text: str
    number: int = 0
    outcome: str = ""


def tokens_of(source):
    """Tokens without comments and space; stops at nothing: what is not known is one sign."""
    found = []
    for match in TOKEN.finditer(source):
        kind = match.lastgroup if match.lastgroup != "hashes" else "string"
        if match["string"] is not None:
            kind = "string"
        if match["space"] is None:
            found.append(Token(kind, match[0], match.start(), match.end()))
    return found


def partners_of(tokens):
    """For every bracket the index of the other one."""
    partner, stack = {}, []
    for index, token in enumerate(tokens):
        if token.kind == "sign" and token.text in OPEN:
            stack.append(index)
        elif token.kind == "sign" and token.text in CLOSE:
            other = stack.pop()
            partner[index], partner[other] = other, index
    return partner


def bodies_of(tokens, partner):
    """Whether each token is in the body of a function that can be mutated: no test, no constant function, no message."""
    inside = [False] * len(tokens)
    text = [token.text for token in tokens]
    for index, token in enumerate(tokens):
        if token.text != "fn" or token.kind != "word" or "const" in text[max(0, index - 2):index]:
            continue
        place = index
        while text[place] not in ("{", ";"):
            place = partner[place] if text[place] in ("(", "[") else place
            place += 1
        if text[place] == "{":
            for inner in range(place + 1, partner[place]):
                inside[inner] = True
    for index in range(len(tokens)):
        if text[index:index + 2] == ["#", "["]:
            end = partner[index + 1]
            region = end
            if text[index:end + 1] in (["#", "[", "cfg", "(", "test", ")", "]"], ["#", "[", "test", "]"]):
                while text[region] not in ("{", ";"):
                    region += 1
                region = partner.get(region, region)
            inside[index:region + 1] = [False] * (region + 1 - index)
        elif text[index] in MESSAGES and index + 2 < len(tokens) and text[index + 1] == "!":
            end = partner[index + 2]
            inside[index:end + 1] = [False] * (end + 1 - index)
    return inside


def closure_start(text, index):
    """Whether the | at this index closes the parameters of a closure."""
    for place in range(index - 1, max(0, index - 60), -1):
        if text[place] in (";", "{"):
            return False
        if text[place] == "|":
            return text[place - 1] in ("(", ",", "=", "move", "=>", "{", ";", "return", "&", "mut")
    return False


def slot_of(tokens, partner, index, statement):
    """First and last token of the smallest expression around a token, or None; of the statement if the token is an assignment."""
    text = [token.text for token in tokens]
    first = index
    condition = False
    while True:
        before = first - 1
        word = text[before]
        if word in ("(", "[", "{", ",", ";", "=>", ":", "return", "else"):
            if word == "else" and text[first] == "if":
                first += 1
                condition = True
            break
        if word in ("if", "while", "match", "in"):
            condition = True
            break
        if word in ("=", "+=", "-=", "*=", "/=", "|=", "&=") and not statement:
            place = before
            while text[place] not in ("let", ";", "{", "}"):
                place = partner[place] if text[place] in (")", "]") else place
                place -= 1
            condition = text[place] == "let" and text[place - 1] in ("if", "while", "&&")
            break
        if word == "|":
            if not closure_start(text, before):
                return None
            break
        if word == "||" and text[before - 1] in ("(", ",", "=", "move"):
            break
        if word == "}" and text[first] not in (".", "?", "else", ")", "+", "-", "*", "/", "as"):
            break
        if word in STATEMENTS or word == "let":
            return None
        first = partner[before] if word in (")", "]", "}") else before
    last = index
    while True:
        after = last + 1
        word = text[after]
        if word in (")", "]", "}", ",", ";") or (condition and word == "{"):
            break
        if word == "=>" or word == ":" or (word == "=" and not statement):
            return None
        last = partner[after] if word in OPEN else after
    words = text[first:last + 1]
    if "let" in words[:1] or (condition and "let" in words) or words[0] in STATEMENTS or tokens[last].end - tokens[first].start > 2000:
        return None
    # A statement that ends with a block and no semicolon is joined with what follows.
    if words[0] in ("if", "while", "match", "for", "loop", "{"):
        return None
    return first, last


def replacement(tokens, index):
    """What a token is replaced by, or None."""
    token, before, after = tokens[index], tokens[index - 1], tokens[index + 1]
    spaced = before.end < token.start and token.end < after.start
    if token.kind == "sign" and token.text in SWAPS and spaced:
        return SWAPS[token.text]
    if token.kind == "sign" and token.text == "-" and before.text in BEFORE_UNARY and token.end == after.start:
        return ""
    if token.kind == "sign" and token.text == "!" and after.text not in ("(", "[", "{") and before.kind != "word" and after.kind == "word":
        return ""
    if token.kind == "number" and token.text in NUMBERS and before.text != ".":
        return NUMBERS[token.text]
    if token.kind == "word" and token.text in WORDS and (token.text in ("true", "false") or (before.text == "." and after.text == "(")):
        return WORDS[token.text]
    return None


def mutants_of(file, source):
    """All mutants of a file."""
    tokens = tokens_of(source)
    partner = partners_of(tokens)
    inside = bodies_of(tokens, partner)
    found = []

    def line_of(token):
        return source.count("\n", 0, token.start) + 1

    for index in range(1, len(tokens) - 1):
        if not inside[index]:
            continue
        token = tokens[index]
        if token.text in ("if", "while") and token.kind == "word" and tokens[index + 1].text != "let":
            slot = slot_of(tokens, partner, index + 1, False)
            if slot and slot[0] == index + 1:
                start, end = tokens[slot[0]].start, tokens[slot[1]].end
                found.append(Mutant(file, line_of(token), f"{token.text} c → {token.text} !c", start, end, f"!({source[start:end]})"))
            continue
        new = replacement(tokens, index)
        if new is None:
            continue
        slot = slot_of(tokens, partner, index, token.text in ("+=", "-=", "*=", "/="))
        if slot:
            start, end = tokens[slot[0]].start, tokens[slot[1]].end
            text = source[start:token.start] + new + source[token.end:end]
            shown = f"{token.text} → {new or 'nothing'}"
            found.append(Mutant(file, line_of(token), shown, start, end, text))
    return found


def switched(source, mutants):
    """The source with these mutants behind switches; every slot and every replacement stands between comments with its number."""
    slots = {}
    for mutant in mutants:
        slots.setdefault((mutant.start, mutant.end), []).append(mutant)
    order = sorted(slots, key=lambda slot: (slot[0], -slot[1]))

    def render(start, end, own):
        out, place = [], start
        while own:
            slot, own = own[0], own[1:]
            within = [other for other in own if other[1] <= slot[1]]
            own = own[len(within):]
            out.append(source[place:slot[0]])
            branches = "".join(
                f"if crate::switch::on({m.number}) {{ /*<{m.number}*/ {m.text} /*{m.number}>*/ }} else " for m in slots[slot]
            )
            name = slots[slot][0].number
            out.append(f"/*[{name}*/({branches}{{ {render(slot[0], slot[1], within)} }})/*{name}]*/")
            place = slot[1]
        out.append(source[place:end])
        return "".join(out)

    return render(0, len(source), order)
