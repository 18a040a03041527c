-- The answer of billion.sql from the answers for its parts.
SELECT mu, sum(collisions) AS collisions, sum(solved) AS solved, sum(slides) AS slides, sum(sticks) AS sticks, sum(renews) AS renews,
  sum(gains_energy) AS gains_energy, checksum(checksum) AS checksum
FROM parts
GROUP BY mu
ORDER BY mu
