-- A thousand million collisions of the two sleds, all of which approach: Newton's hypothesis, 100 coefficients of friction.
SELECT mu, count(*) AS collisions, count(*) FILTER (WHERE c['kind'] = 'ok') AS solved,
  count(*) FILTER (WHERE c['path'] = 'sliding') AS slides,
  count(*) FILTER (WHERE c['path'] = 'sliding, then sticking') AS sticks,
  count(*) FILTER (WHERE c['path'] = 'sliding, then renewal') AS renews,
  count(*) FILTER (WHERE energy_gained(c) > 0.0) AS gains_energy,
  checksum(outcome_hash(c)) AS checksum
FROM (
  SELECT mu, two_sleds_collide(named_struct('mu', mu, 'e', 0.8, 'law', 'newton', 'u1', 1.0 + uniform(i, 0, 1),
      'u3', 0.2 * uniform(i, 1, 1), 'u4', 1.0 + uniform(i, 2, 1), 'u6', 0.2 * uniform(i, 3, 1))) AS c
  FROM (SELECT i, linspace(i % 100, 0.0, 2.0, 100) AS mu FROM rows(1e9)))
GROUP BY mu
ORDER BY mu
