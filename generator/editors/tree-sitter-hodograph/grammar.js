/**
 * The grammar of models, for editors. It accepts what the parser of `hodograph-model` accepts, but for the order
 * of sections and the places of documentation; `generator/editors/acceptance` compares the two.
 */
/// <reference types="tree-sitter-cli/dsl" />

const comma = (rule) => optional(seq(rule, repeat(seq(',', rule)), optional(',')));
const semicolon = (rule) => repeat(seq(rule, ';'));
const section = (word, entries) => seq(field('section', word), '{', entries, '}');

module.exports = grammar({
  name: 'hodograph',
  word: ($) => $.name,
  externals: ($) => [$.block_comment],
  extras: ($) => [/[\s\uFEFF]/, $.line_comment, $.block_comment],

  rules: {
    model: ($) =>
      choice(
        seq('mechanism', field('mechanism', $.name), ';', repeat(choice($._item, $.import, $.count, $.part))),
        // a file of parts
        repeat1(choice($.import, $.part)),
      ),
    _item: ($) => choice($.section, $.use, $.for),
    import: ($) => seq('import', $.string, ';'),
    count: ($) => seq('count', field('name', $.name), '=', $.expression, ';'),
    part: ($) => seq('part', field('name', $.name), optional(seq('(', comma($.argument), ')')), $.block),
    argument: ($) =>
      seq(field('name', $.name), ':', field('unit', $.unit), optional(seq('of', $._place)), optional(seq('=', $.expression))),
    block: ($) => seq('{', repeat($._item), '}'),
    use: ($) =>
      seq('use', field('part', $.name), 'as', field('name', $._declared), optional(seq('(', comma($.given), ')')), ';'),
    given: ($) => seq($.name, ':', $.expression, optional(seq('of', $._place))),
    for: ($) => seq('for', field('name', $.name), 'in', $.expression, '..', $.expression, $.block),
    // what is declared for each turn of a repetition has an index; what is of an instance follows its name
    _declared: ($) => choice($.name, $.indexed),
    indexed: ($) => seq($.name, '[', $.expression, ']'),
    _place: ($) => choice($.name, $.path),
    path: ($) => seq($.name, repeat1(choice(seq('.', $.name), seq('[', $.expression, ']')))),

    section: ($) =>
      choice(
        section(choice('parameters', 'inputs', 'coordinates', 'speeds', 'dependent'), comma($.quantity)),
        section('definitions', semicolon($.definition)),
        section('frames', semicolon($.frame)),
        section('angular_velocities', semicolon($.angular_velocity)),
        section('points', semicolon($.point)),
        section('velocities', semicolon($.velocity)),
        section(choice('bodies', 'particles', 'shapes', 'contacts'), comma($.record)),
        section('loads', semicolon($.load)),
        section(choice('kinematics', 'constraints', 'configuration'), semicolon($.equation)),
      ),

    quantity: ($) =>
      seq(
        repeat(choice('fixed', 'dependent', 'shared')),
        field('name', choice($._declared, alias('fixed', $.name), alias('dependent', $.name), alias('shared', $.name))),
        ':',
        field('unit', $.unit),
        optional(seq('=', $.expression)),
      ),
    unit: ($) => $.expression,
    definition: ($) => seq(field('name', $._declared), optional(seq(':', field('unit', $.unit))), '=', $.expression),
    frame: ($) => seq(field('name', $._declared), '=', $.expression),
    angular_velocity: ($) => seq($._place, optional(seq('in', $._place)), '=', $.expression),
    point: ($) =>
      seq(
        field('name', $._declared),
        optional(seq('of', $._place)),
        choice(seq('=', $.expression), seq(':', 'velocity', $.expression)),
      ),
    velocity: ($) => seq($._place, '=', $.expression),
    record: ($) => seq(field('name', $._declared), $.fields),
    fields: ($) => seq('{', comma(choice($.field, $.pair)), '}'),
    field: ($) =>
      choice(
        seq(field('field', $.name), ':', $._value),
        seq(field('field', alias('surface', $.name)), ':', choice($._value, alias($.surface, $.fields))),
      ),
    // inside of a surface there is no other
    surface: ($) => seq('{', comma(alias($.plain_field, $.field)), '}'),
    plain_field: ($) => seq(field('field', $.name), ':', $._value),
    _value: ($) =>
      seq(
        choice(
          seq(optional('velocity'), $.expression),
          alias('velocity', $.name),
        ),
        repeat(seq(choice('in', 'about', 'of'), $._place)),
      ),
    pair: ($) => seq($._place, choice('on', 'in'), $._place),
    load: ($) =>
      seq(
        field('load', $.name),
        repeat(seq(optional(choice('on', 'from', 'to')), $._place)),
        optional(seq('about', $.expression)),
        ':',
        choice($.expression, $.fields),
      ),
    equation: ($) => seq($.expression, '=', $.expression),

    expression: ($) =>
      choice($.sum, $.product, $.sign, $.power, $.rate, $._base),
    _name: ($) => choice($.name, alias('d', $.name)),
    sum: ($) => prec.left(1, seq($.expression, choice('+', '-'), $.expression)),
    product: ($) => prec.left(2, seq($.expression, choice('*', '/'), $.expression)),
    sign: ($) => prec(3, seq(choice('-', '+'), $.expression)),
    power: ($) => prec.right(4, seq($._base, '^', $.expression)),
    // a power of a rate is put in parentheses
    _base: ($) => choice($.member, $.index, $.call, $.parentheses, $.list, $.number, $._name),
    rate: ($) => prec(5, seq('d', '(', $.expression, ')', '/', 'dt')),
    member: ($) =>
      prec.left(6, seq($.expression, '.', field('member', $.name), optional(field('arguments', $.arguments)))),
    index: ($) => prec.left(6, seq($.expression, '[', $.expression, ']')),
    call: ($) => prec(6, seq(field('function', $.name), $.arguments)),
    arguments: ($) => seq('(', comma($.expression), ')'),
    parentheses: ($) => seq('(', $.expression, ')'),
    list: ($) => seq('[', comma($.expression), ']'),

    name: (_) => /[_\p{XID_Start}][_\p{XID_Continue}]*/u,
    number: (_) => token(/\d+(\.\d+)?([eE][+-]?\d+)?/),
    string: (_) => /"[^"\n]*"/,
    line_comment: (_) => token(seq('//', /[^\n]*/)),
  },
});
