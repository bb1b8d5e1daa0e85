"""Rules of studies: one file each, whose function `rule` makes numbers of rows and whose function `draw`,
where there is one, makes figures of these numbers.
"""
