-- How the rebound of a double pendulum from a wall spreads where each of its masses and lengths has a tolerance of 1 % (standard deviation): all of them at
-- once, and each alone. The speed of separation and the rate of the lower rod after the collision, counted in bins.
SELECT which, count(*) AS collisions, count(*) FILTER (WHERE c['kind'] = 'ok') AS solved,
  histogram(c['separation_n'], 0.64, 0.76, 60) AS separation, histogram(c['after_u2'], -1.85, -1.65, 80) AS rate,
  checksum(outcome_hash(c)) AS checksum
FROM (
  SELECT which, planar_double_pendulum_collide(named_struct('mu', 0.3, 'e', 0.6, 'law', 'stronge',
      'm1', 1.3 * (1.0 + CASE WHEN which IN ('all', 'm1') THEN 0.01 * normal(i, 0, 1) ELSE 0.0 END),
      'm2', 0.9 * (1.0 + CASE WHEN which IN ('all', 'm2') THEN 0.01 * normal(i, 1, 1) ELSE 0.0 END),
      'l1', 0.7 * (1.0 + CASE WHEN which IN ('all', 'l1') THEN 0.01 * normal(i, 2, 1) ELSE 0.0 END),
      'l2', 0.5 * (1.0 + CASE WHEN which IN ('all', 'l2') THEN 0.01 * normal(i, 3, 1) ELSE 0.0 END))) AS c
  FROM (SELECT i, CASE i % 5 WHEN 0 THEN 'all' WHEN 1 THEN 'm1' WHEN 2 THEN 'm2' WHEN 3 THEN 'l1' ELSE 'l2' END AS which FROM rows(100000)))
GROUP BY which
ORDER BY which
