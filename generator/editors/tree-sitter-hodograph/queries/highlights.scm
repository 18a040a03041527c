; The kind of a name (parameter, frame, point ..) is known to the language server alone.
[(line_comment) (block_comment)] @comment
((line_comment) @comment.documentation (#match? @comment.documentation "^//[/!]"))
"mechanism" @keyword
(section section: _ @keyword)
["import" "count" "part" "use" "as" "for" "shared"] @keyword
(string) @string
(part name: (name) @type)
["fixed" "dependent" "of" "in" "on" "from" "to" "about" "velocity"] @keyword
(model mechanism: (name) @type)
(number) @number
(indexed (name) @variable)
(unit (_) @type)
(unit (name) @type)
(field field: (name) @property)
(load load: (name) @function)
(quantity name: (name) @variable)
(definition name: (name) @constant)
(frame name: (name) @type)
(point name: (name) @variable)
(record name: (name) @type)
(call function: (name) @function)
(member member: (name) @property)
(rate ["d" "dt"] @function)
["+" "-" "*" "/" "^" "="] @operator
["(" ")" "[" "]" "{" "}"] @punctuation.bracket
["," ";" ":" "."] @punctuation.delimiter
